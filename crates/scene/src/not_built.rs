//! What scene files may say but nothing renders yet. Building a feature deletes its line here.
//!
//! A key found here is an error that says so, never ignored. The schema and docs/scene.md
//! carry the same notes.

/// A key that is known but not built.
pub(crate) struct NotBuilt {
    /// The key with its tables, without indices.
    pub(crate) path: &'static str,
    /// What to do instead.
    pub(crate) instead: &'static str,
}

/// The whole list.
pub(crate) const NOT_BUILT: &[NotBuilt] = &[];

/// The entry of a key, if it has one.
pub(crate) fn not_built(path: &str) -> Option<&'static NotBuilt> {
    NOT_BUILT.iter().find(|entry| entry.path == path)
}
