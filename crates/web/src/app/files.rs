//! Files in and out: dialogs, dropped files, downloads; in the browser and in a window.

use std::sync::{Arc, Mutex};

use eframe::egui;

use crate::source::Source;

/// A file, or why it could not be read.
type Arrived = Result<Source, String>;

/// Files that were opened or dropped and wait to be loaded.
#[derive(Clone)]
pub(super) struct Inbox {
    arrived: Arc<Mutex<Vec<Arrived>>>,
    ctx: egui::Context,
}

impl Inbox {
    pub(super) fn new(ctx: egui::Context) -> Self {
        Self { arrived: Arc::default(), ctx }
    }

    /// What has arrived since the last time.
    pub(super) fn take(&self) -> Vec<Arrived> {
        self.arrived.lock().map(|mut a| std::mem::take(&mut *a)).unwrap_or_default()
    }

    fn put(&self, arrived: Arrived) {
        if let Ok(mut all) = self.arrived.lock() {
            all.push(arrived);
        }
        self.ctx.request_repaint();
    }

    /// Reads files that were dropped on the page.
    pub(super) fn take_dropped(&self, ctx: &egui::Context) {
        for file in ctx.input(|i| i.raw.dropped_files.clone()) {
            let inbox = self.clone();
            // Reading takes time, so it gets a thread.
            #[cfg(not(target_arch = "wasm32"))]
            std::thread::spawn(move || inbox.put(Source::open(file.path())));
            #[cfg(target_arch = "wasm32")]
            wasm_bindgen_futures::spawn_local(async move {
                let name = file.path().display().to_string();
                inbox.put(match file.bytes_async().await {
                    Ok(bytes) => Ok(Source::alone(name, bytes)),
                    Err(reason) => Err(format!("{name}: {reason}")),
                });
            });
        }
    }
}

/// A picture as PNG.
pub(super) fn png(image: &egui::ColorImage) -> Result<Vec<u8>, png::EncodingError> {
    let [width, height] = image.size.map(|s| s as u32);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(image.as_raw())?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(not(target_arch = "wasm32"))]
const EXTENSIONS: [&str; 6] = ["obj", "glb", "gltf", "ply", "stl", "off"];

#[cfg(not(target_arch = "wasm32"))]
impl Inbox {
    /// Asks for a file.
    pub(super) fn ask(&self) {
        let inbox = self.clone();
        // The dialog blocks, so it gets a thread.
        std::thread::spawn(move || {
            if let Some(path) = rfd::FileDialog::new().add_filter("meshes", &EXTENSIONS).pick_file() {
                inbox.put(Source::open(&path));
            }
        });
    }
}

/// Saves a file where the person says.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn save(name: &str, bytes: Vec<u8>) -> Result<(), String> {
    let name = name.to_owned();
    std::thread::Builder::new()
        .spawn(move || {
            if let Some(path) = rfd::FileDialog::new().set_file_name(name).save_file()
                && let Err(error) = std::fs::write(&path, bytes)
            {
                rfd::MessageDialog::new().set_description(format!("{}: {error}", path.display())).show();
            }
        })
        .map(drop)
        .map_err(|e| e.to_string())
}

/// The command that opens the same again.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn address(link: &crate::settings::Link) -> String {
    format!("ldwrap-web '#{}'", link.fragment())
}

#[cfg(target_arch = "wasm32")]
pub(super) use browser::{address, save};

#[cfg(target_arch = "wasm32")]
mod browser {
    use wasm_bindgen::JsCast as _;
    use wasm_bindgen::closure::Closure;
    use web_sys::{Blob, BlobPropertyBag, HtmlAnchorElement, HtmlInputElement, Url};

    use super::Inbox;
    use crate::settings::Link;
    use crate::source::Source;

    fn document() -> Option<web_sys::Document> {
        web_sys::window()?.document()
    }

    impl Inbox {
        /// Asks for a file.
        pub(in super::super) fn ask(&self) {
            let Some(input) = document().and_then(|d| d.create_element("input").ok()) else { return };
            let Ok(input) = input.dyn_into::<HtmlInputElement>() else { return };
            input.set_type("file");
            input.set_accept(".obj,.glb,.gltf,.ply,.stl,.off");
            let inbox = self.clone();
            let chosen = input.clone();
            let on_change = Closure::once_into_js(move || {
                let Some(file) = chosen.files().and_then(|f| f.get(0)) else { return };
                wasm_bindgen_futures::spawn_local(async move {
                    let name = file.name();
                    let read = file.array_buffer().await;
                    inbox.put(match read {
                        Ok(buffer) => Ok(Source::alone(name, js_sys::Uint8Array::new(&buffer).to_vec())),
                        Err(error) => Err(format!("{name}: {error:?}")),
                    });
                });
            });
            input.set_onchange(Some(on_change.unchecked_ref()));
            input.click();
        }
    }

    /// Downloads a file.
    pub(in super::super) fn save(name: &str, bytes: Vec<u8>) -> Result<(), String> {
        let failed = |_| format!("{name} could not be downloaded");
        let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes.as_slice()));
        let kind = BlobPropertyBag::new();
        kind.set_type("application/octet-stream");
        let blob = Blob::new_with_u8_array_sequence_and_options(&parts, &kind).map_err(failed)?;
        let url = Url::create_object_url_with_blob(&blob).map_err(failed)?;
        let anchor =
            document().and_then(|d| d.create_element("a").ok()).ok_or_else(|| failed(Default::default()))?;
        let anchor: HtmlAnchorElement = anchor.dyn_into().map_err(|_| failed(Default::default()))?;
        anchor.set_href(&url);
        anchor.set_download(name);
        anchor.click();
        Url::revoke_object_url(&url).map_err(failed)
    }

    /// The address that opens the same again.
    pub(in super::super) fn address(link: &Link) -> String {
        let location = web_sys::window().map(|w| w.location());
        let here = location.and_then(|l| l.href().ok()).unwrap_or_default();
        let base = here.split('#').next().unwrap_or_default();
        format!("{base}#{}", link.fragment())
    }
}
