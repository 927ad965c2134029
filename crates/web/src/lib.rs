//! The page of ldwrap: see the strips, the points, and what a view sees. And ldwrap for JavaScript.
//!
//! | module | what | runs |
//! |---|---|---|
//! | [`settings`] | what a person sets; becomes the library's options, a link, JSON | everywhere |
//! | [`source`] | where a mesh comes from: a built-in shape or a file's bytes | everywhere |
//! | [`engine`] | does the work: jobs in, answers out; holds the mesh and the runs | worker or thread |
//! | [`scene`] | what the engine tells the page about a mesh and a run: plain numbers to draw | both |
//! | [`upright`] | guesses which axis of a mesh points up | worker or thread |
//! | [`model`] | the page's whole state, without a window | page |
//! | [`app`] | draws the model with egui and turns gestures into calls on it | page |
//! | `api` | the JavaScript API | JavaScript |
//!
//! The page never works itself: it posts jobs to a web worker (in a window: a thread) and draws what comes back.

#[cfg(target_arch = "wasm32")]
pub mod api;
#[cfg(feature = "page")]
pub mod app;
pub mod camera;
pub mod engine;
pub mod export;
pub mod figure;
pub mod journal;
pub mod judge;
pub mod look;
pub mod model;
pub mod pick;
pub mod report;
pub mod scene;
pub mod settings;
pub mod source;
pub mod upright;
