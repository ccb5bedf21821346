//! Who hears how far a study is.

/// Hears progress. `()` hears nothing.
pub trait Watch: Sync {
    /// The share of a stage that is done, in [0, 1]; from any thread.
    fn progress(&self, stage: &str, done: f64);
}

impl Watch for () {
    fn progress(&self, _: &str, _: f64) {}
}
