//! What scene files may say but nothing renders yet. Building a feature deletes its line here.
//!
//! A key or value found here is an error that says so, never ignored. The schema and docs/scene.md
//! carry the same notes.

/// A key, or some values of it, that is known but not built.
pub(crate) struct NotBuilt {
    /// The key with its tables, without indices.
    pub(crate) path: &'static str,
    pub(crate) when: When,
    /// What to do instead.
    pub(crate) instead: &'static str,
}

/// Which uses of a key are not built.
pub(crate) enum When {
    /// Any.
    Present,
    /// These choices.
    Is(&'static [&'static str]),
}

const fn key(path: &'static str) -> NotBuilt {
    NotBuilt { path, when: When::Present, instead: "remove it" }
}

const fn value(path: &'static str, when: When, instead: &'static str) -> NotBuilt {
    NotBuilt { path, when, instead }
}

/// The whole list.
pub(crate) const NOT_BUILT: &[NotBuilt] = &[
    value("render.loop", When::Is(&["queue"]), "use \"images\" or \"auto\""),
    key("objects.filter"),
];

/// The entry of a key, if it has one.
pub(crate) fn not_built(path: &str) -> Option<&'static NotBuilt> {
    NOT_BUILT.iter().find(|entry| entry.path == path)
}

impl NotBuilt {
    /// What is not built, in words that follow the key's name.
    pub(crate) fn note(&self) -> String {
        match self.when {
            When::Present => "not built yet".into(),
            When::Is(names) => {
                let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
                format!("{} not built yet", quoted.join(", "))
            }
        }
    }
}
