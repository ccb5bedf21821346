//! Photon density.
