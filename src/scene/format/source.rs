//! Bytes in, within a budget.

use super::Code;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

/// The files of one scene may hold this many bytes in all; a file that is read twice counts twice.
pub const MAX_SCENE_BYTES: u64 = 256 << 20;

/// How many bytes may still be read for a scene.
#[derive(Debug)]
pub(super) struct Budget {
    left: u64,
}

impl Budget {
    pub(super) fn new() -> Self {
        Self { left: MAX_SCENE_BYTES }
    }

    /// Reads a whole regular file.
    ///
    /// # Errors
    /// The code and what was found: missing, a folder or a device, unreadable, or beyond the budget.
    pub(super) fn read(&mut self, path: &Path) -> Result<Vec<u8>, (Code, String)> {
        // Refuse folders, pipes and devices before they are opened: opening a pipe waits, a device may never end.
        let unreadable =
            |e: std::io::Error| (Code::UnreadableFile, format!("`{}` cannot be read: {e}", path.display()));
        let metadata = fs::metadata(path).map_err(unreadable)?;
        if !metadata.is_file() {
            let kind = if metadata.is_dir() { "a folder" } else { "no regular file" };
            return Err((Code::UnreadableFile, format!("`{}` is {kind}", path.display())));
        }

        // Read no more than the budget, whatever length the file claims.
        let too_large = || (Code::TooLarge, format!("with `{}`, the scene is larger than 256 MiB", path.display()));
        if metadata.len() > self.left {
            return Err(too_large());
        }
        let mut bytes = Vec::new();
        File::open(path).and_then(|file| file.take(self.left + 1).read_to_end(&mut bytes)).map_err(unreadable)?;
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or_else(too_large)?;
        Ok(bytes)
    }
}
