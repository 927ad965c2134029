//! The JavaScript API: [`wrap`] for programs, [`start`] for the page, [`Work`] for its worker.

use ldwrap::{Progress, Silent};
use wasm_bindgen::prelude::*;

use crate::engine::{self, Answer, Engine, Job};
use crate::settings::Settings;
use crate::source::Source;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** How many points: exactly one of these. */
export type Request = { count: number } | { density: number } | { spacing: number } | { irregularity: number };

/** The point set on the planar domain. */
export type Sequence =
  | { hammersley: { base: number } }
  | { halton: { bases: [number, number] } }
  | { sobol: { seed: number } }
  | "r2"
  | "fibonacci";

/** Everything that decides the points, besides the mesh; what is left out has its default. */
export interface Options {
  /** Default: { count: 1000 }, exactly met. Density and spacing are in units of the mesh. */
  request?: Request;
  /** "wrap" (default), "paper" (the paper's growth, not equalized), or a baseline. */
  method?: string;
  /** Default: { hammersley: { base: 2 } }. */
  sequence?: Sequence;
  /** Shifts the point set; 0 (default) leaves it as it is. */
  seed?: number;
  /** The largest angle in degrees that counts as almost flat. Default: 60. */
  flatnessAngle?: number;
  /** Default: "least-open". */
  growth?: "least-open" | "rehung" | "flattest-first" | "boundary-walk" | "longest-first";
  /** Smaller segments go on growing; a share of all triangles. Default: 0.002. */
  smallestShare?: number;
  /** Interstices and overlaps thinner than this many d_m are corrected. Default: 0.1. */
  tolerance?: number;
  /** Whether every point is moved to stand for the same area. Default: true. */
  equalize?: boolean;
}

/** Points on a surface; element i of every array belongs to point i. */
export interface Wrapped {
  /** x, y, z of each point, in units of the mesh. */
  positions: Float32Array;
  /** The outward unit normal of each point's face. */
  normals: Float32Array;
  /** The triangle that holds each point, among those of the checked mesh. */
  faces: Uint32Array;
  /** The weights of the triangle's three corners, in full precision. */
  barycentric: Float64Array;
  /** The strip that holds each point. */
  strips: Uint32Array;
  /** The report, with the keys of the command line program's. */
  report: Record<string, unknown>;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `Options` of the types above.
    #[wasm_bindgen(typescript_type = "Options")]
    pub type JsOptions;
    /// `Wrapped` of the types above.
    #[wasm_bindgen(typescript_type = "Wrapped")]
    pub type JsWrapped;
}

/// Spreads points over a mesh. `bytes` are those of an OBJ, GLB, PLY, STL or OFF file, `name` its name. The same
/// bytes, options and seed give the same bits as the command line program. Throws an `Error` with the reason when
/// the mesh or the options are wrong.
#[wasm_bindgen]
pub fn wrap(bytes: &[u8], name: &str, options: Option<JsOptions>) -> Result<JsWrapped, JsError> {
    run(&Source::alone(name.to_owned(), bytes.to_vec()), options)
}

/// Spreads points over a built-in shape; see `shapes`.
#[wasm_bindgen(js_name = wrapShape)]
pub fn wrap_shape(name: &str, options: Option<JsOptions>) -> Result<JsWrapped, JsError> {
    let shape = name.parse().map_err(|e: ldwrap::shapes::UnknownShape| JsError::new(&e.to_string()))?;
    run(&Source::Shape(shape), options)
}

/// The names of the built-in shapes.
#[wasm_bindgen]
pub fn shapes() -> Vec<String> {
    ldwrap::shapes::Shape::ALL.iter().map(|s| s.name().to_owned()).collect()
}

/// The version of ldwrap.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

fn run(source: &Source, options: Option<JsOptions>) -> Result<JsWrapped, JsError> {
    let fail = |reason: String| JsError::new(&reason);
    let settings = match options.map(JsValue::from).filter(|v| !v.is_undefined() && !v.is_null()) {
        Some(value) => {
            let json =
                js_sys::JSON::stringify(&value).map_err(|_| fail("the options are not plain data".into()))?;
            Settings::from_json(&String::from(json)).map_err(fail)?
        }
        None => Settings::default(),
    };
    let (mesh, repaired) = source.load().map_err(fail)?;
    let made = engine::make(&mesh, &repaired, settings, &Silent, &clock).map_err(fail)?;
    let samples = &made.run.samples;
    let positions: Vec<f32> =
        samples.iter().flat_map(|s| mesh.locate(&s.point).as_vec3().to_array()).collect();
    let normals: Vec<f32> =
        samples.iter().flat_map(|s| mesh.face_normal(s.point.face).as_vec3().to_array()).collect();
    let faces: Vec<u32> = samples.iter().map(|s| s.point.face.0).collect();
    let strips: Vec<u32> = samples.iter().map(|s| s.strip.0).collect();
    let barycentric: Vec<f64> = samples.iter().flat_map(|s| s.point.barycentric).collect();
    let report = js_sys::JSON::parse(&made.scene.report).map_err(|_| fail("the report is no JSON".into()))?;
    let wrapped = js_sys::Object::new();
    let fields: [(&str, JsValue); 6] = [
        ("positions", js_sys::Float32Array::from(positions.as_slice()).into()),
        ("normals", js_sys::Float32Array::from(normals.as_slice()).into()),
        ("faces", js_sys::Uint32Array::from(faces.as_slice()).into()),
        ("barycentric", js_sys::Float64Array::from(barycentric.as_slice()).into()),
        ("strips", js_sys::Uint32Array::from(strips.as_slice()).into()),
        ("report", report),
    ];
    for (name, value) in fields {
        js_sys::Reflect::set(&wrapped, &name.into(), &value)
            .map_err(|_| fail("an object without fields".into()))?;
    }
    Ok(JsValue::from(wrapped).unchecked_into())
}

/// Seconds since 1970.
fn clock() -> f64 {
    js_sys::Date::now() / 1000.0
}

/// What the page's worker runs: jobs in, answers out, both as bytes that only the page understands.
#[wasm_bindgen(skip_typescript)]
pub struct Work {
    engine: Engine,
    tell: js_sys::Function,
}

#[wasm_bindgen]
impl Work {
    /// `tell` is called with the bytes of each answer.
    #[wasm_bindgen(constructor)]
    pub fn new(tell: js_sys::Function) -> Self {
        Self { engine: Engine::default(), tell }
    }

    /// Does a job.
    pub fn handle(&mut self, job: &[u8]) {
        let answer = match postcard::from_bytes::<Job>(job) {
            Ok(job) => {
                TELLING.set(Some((self.tell.clone(), 0.0)));
                self.engine.handle(job, &Telling, &clock)
            }
            Err(error) => Answer::Failed(format!("a garbled job: {error}")),
        };
        tell(&self.tell, &answer);
    }
}

thread_local! {
    /// Whom to tell of progress, and when that was done last.
    static TELLING: std::cell::RefCell<Option<(js_sys::Function, f64)>> = const { std::cell::RefCell::new(None) };
    static STAGE: std::cell::Cell<(&'static str, u64, u64)> = const { std::cell::Cell::new(("", 0, 0)) };
}

struct Telling;

impl Telling {
    fn tell(&self) {
        TELLING.with_borrow_mut(|telling| {
            let Some((function, last)) = telling else { return };
            let now = clock();
            if now - *last < 0.1 {
                return;
            }
            *last = now;
            let (stage, done, all) = STAGE.get();
            let share = (all > 1).then(|| done as f32 / all as f32);
            tell(function, &Answer::Progress(stage.to_owned(), share));
        });
    }
}

impl Progress for Telling {
    fn begin(&self, stage: &'static str, steps: u64) {
        STAGE.set((stage, 0, steps));
        self.tell();
    }

    fn advance(&self, steps: u64) {
        let (stage, done, all) = STAGE.get();
        STAGE.set((stage, done + steps, all));
        self.tell();
    }
}

fn tell(function: &js_sys::Function, answer: &Answer) {
    let bytes = postcard::to_stdvec(answer).unwrap_or_default();
    // The function is the worker's own and throws nothing.
    let _ = function.call1(&JsValue::NULL, &js_sys::Uint8Array::from(bytes.as_slice()));
}

#[cfg(feature = "page")]
pub mod page {
    //! Starts the page on a canvas.

    use super::*;
    use crate::app::App;
    use crate::settings::Link;

    /// The running page.
    #[wasm_bindgen(skip_typescript)]
    pub struct Page {
        runner: eframe::WebRunner,
    }

    /// Starts the page on a canvas.
    #[wasm_bindgen(skip_typescript)]
    pub async fn start(canvas: web_sys::HtmlCanvasElement) -> Result<Page, JsValue> {
        let runner = eframe::WebRunner::new();
        let fragment = web_sys::window().and_then(|w| w.location().hash().ok()).unwrap_or_default();
        let link = Link::from_fragment(&fragment);
        let create: eframe::AppCreator<'static> = Box::new(move |cc| Ok(Box::new(App::new(cc, link, None)?)));
        runner.start(canvas, eframe::WebOptions::default(), create).await?;
        Ok(Page { runner })
    }

    #[wasm_bindgen]
    impl Page {
        /// The state as JSON, for tests.
        pub fn inspect(&self) -> Option<String> {
            self.runner.app_mut::<App>().map(|app| app.inspect().to_string())
        }

        /// Why the page stopped, if it did.
        pub fn panic(&self) -> Option<String> {
            self.runner.panic_summary().map(|p| p.message())
        }
    }
}
