//! What the numbers mean: the prose between the tables.

pub(crate) const HEAD: &str = include_str!("text/head.md");
pub(crate) const SPHERE: &str = include_str!("text/sphere.md");
pub(crate) const CUP: &str = include_str!("text/cup.md");
pub(crate) const DRINK: &str = include_str!("text/drink.md");
pub(crate) const DRINK_LIKE: &str = include_str!("text/drink-like.md");
pub(crate) const HORSE: &str = include_str!("text/horse.md");
pub(crate) const ALL: &str = include_str!("text/all.md");
pub(crate) const FEWER: &str = include_str!("text/fewer.md");
pub(crate) const WHY: &str = include_str!("text/why.md");
