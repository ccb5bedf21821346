//! Moments, tests and fits. Knows no light.
