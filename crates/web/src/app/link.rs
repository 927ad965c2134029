//! The way to an engine: a thread beside the window, a web worker beside the page.

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(not(target_arch = "wasm32"))]
mod native;

#[cfg(target_arch = "wasm32")]
pub(super) use browser::EngineLink;
#[cfg(not(target_arch = "wasm32"))]
pub(super) use native::EngineLink;
