//! One file a command: from its arguments to its outputs.

pub(crate) mod batch;
pub(crate) mod bound;
pub(crate) mod compare;
pub(crate) mod help;
pub(crate) mod info;
pub(crate) mod measure;
pub(crate) mod plane;
pub(crate) mod shape;
pub(crate) mod strips;
pub(crate) mod view;
pub(crate) mod wrap;

/// `1 point`, `2 points`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
