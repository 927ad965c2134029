//! Mirrors AccessKit's tree into the page, because a canvas is silent: every control becomes an invisible element
//! with its role, name, value and place, which screen readers read and click.

use std::cell::RefCell;
use std::collections::BTreeMap;

use eframe::egui::{self, Event, FullOutput, RawInput};
use egui::accesskit::{Action, ActionRequest, Node, NodeId, Role, Toggled, TreeId, TreeUpdate};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::{Document, Element};

thread_local! {
    static MIRROR: RefCell<Mirror> = RefCell::default();
}

#[derive(Default)]
struct Mirror {
    shown: BTreeMap<u64, (Element, Shown)>,
    clicked: Vec<u64>,
    status: String,
}

/// What an element says of a control.
#[derive(Clone, Debug, PartialEq)]
struct Shown {
    role: &'static str,
    name: String,
    value: Option<String>,
    checked: Option<bool>,
    disabled: bool,
    place: [i32; 4],
}

struct Plugin;

impl egui::Plugin for Plugin {
    fn debug_name(&self) -> &'static str {
        "mirror"
    }

    fn input_hook(&mut self, _: &egui::Context, input: &mut RawInput) {
        let clicked = MIRROR.with_borrow_mut(|m| std::mem::take(&mut m.clicked));
        input.events.extend(clicked.into_iter().map(|id| {
            Event::AccessKitActionRequest(ActionRequest {
                action: Action::Click,
                target_tree: TreeId::ROOT,
                target_node: NodeId(id),
                data: None,
            })
        }));
    }

    fn output_hook(&mut self, _: &egui::Context, output: &mut FullOutput) {
        if let Some(update) = output.platform_output.accesskit_update.take() {
            MIRROR.with_borrow_mut(|m| m.show(&update));
        }
    }
}

fn document() -> Option<Document> {
    web_sys::window()?.document()
}

fn container() -> Option<Element> {
    document()?.get_element_by_id("mirror")
}

/// Mirrors from now on.
pub(super) fn install(ctx: &egui::Context) {
    ctx.enable_accesskit();
    ctx.add_plugin(Plugin);
    let repaint = ctx.clone();
    let on_click = Closure::<dyn FnMut(web_sys::Event)>::new(move |event: web_sys::Event| {
        let target = event.target().and_then(|t| t.dyn_into::<Element>().ok());
        let id = target.and_then(|t| t.get_attribute("data-id")).and_then(|id| id.parse().ok());
        if let Some(id) = id {
            MIRROR.with_borrow_mut(|m| m.clicked.push(id));
            repaint.request_repaint();
        }
    });
    if let Some(container) = container() {
        // Without it the controls are still read, only not clicked.
        let _ = container.add_event_listener_with_callback("click", on_click.as_ref().unchecked_ref());
    }
    on_click.forget();
}

/// Says in a live region what is shown now.
pub(super) fn tell(status: &str) {
    MIRROR.with_borrow_mut(|m| {
        if m.status != status
            && let Some(region) = document().and_then(|d| d.get_element_by_id("status"))
        {
            region.set_text_content(Some(status));
            status.clone_into(&mut m.status);
        }
    });
}

impl Mirror {
    fn show(&mut self, update: &TreeUpdate) {
        let (Some(document), Some(container)) = (document(), container()) else { return };
        let nodes: BTreeMap<u64, &Node> = update.nodes.iter().map(|(id, node)| (id.0, node)).collect();
        let wanted: BTreeMap<u64, Shown> =
            nodes.iter().filter_map(|(id, node)| Some((*id, shown(node, &nodes)?))).collect();
        self.shown.retain(|id, (element, _)| {
            let keep = wanted.contains_key(id);
            if !keep {
                element.remove();
            }
            keep
        });
        for (id, now) in wanted {
            match self.shown.get_mut(&id) {
                Some((_, before)) if *before == now => {}
                Some((element, before)) => {
                    write(element, &now);
                    *before = now;
                }
                None => {
                    let Ok(element) = document.create_element("div") else { continue };
                    // Attributes with these names can always be set.
                    let _ = element.set_attribute("data-id", &id.to_string());
                    write(&element, &now);
                    let _ = container.append_child(&element);
                    self.shown.insert(id, (element, now));
                }
            }
        }
    }
}

fn write(element: &Element, shown: &Shown) {
    let [x, y, width, height] = shown.place;
    let set = |name: &str, value: Option<&str>| {
        // Attributes with these names can always be set.
        let _ = match value {
            Some(value) => element.set_attribute(name, value),
            None => element.remove_attribute(name),
        };
    };
    let flag = |on: bool| if on { "true" } else { "false" };
    set("role", Some(shown.role));
    set("aria-label", Some(&shown.name));
    set("aria-valuetext", shown.value.as_deref());
    set("aria-checked", shown.checked.map(flag));
    set("aria-disabled", shown.disabled.then_some("true"));
    set("style", Some(&format!("left:{x}px;top:{y}px;width:{width}px;height:{height}px")));
}

fn shown(node: &Node, nodes: &BTreeMap<u64, &Node>) -> Option<Shown> {
    let role = aria(node.role())?;
    // A control without a name is shown too: that it is there is better than silence.
    let name = match name(node, nodes, 3) {
        Some(name) => name.to_owned(),
        None if is_control(role) => String::new(),
        None => return None,
    };
    let value = node.value().map(str::to_owned).or_else(|| node.numeric_value().map(|v| v.to_string()));
    let bounds = node.bounds()?;
    Some(Shown {
        role,
        value: value.filter(|v| *v != name),
        name,
        checked: node.toggled().map(|t| t == Toggled::True),
        disabled: node.is_disabled(),
        place: [bounds.x0, bounds.y0, bounds.x1 - bounds.x0, bounds.y1 - bounds.y0].map(|v| v.round() as i32),
    })
}

/// The name of a node: its own, or that of what it is labelled by, which may be labelled in turn.
fn name<'a>(node: &'a Node, nodes: &BTreeMap<u64, &'a Node>, steps: u32) -> Option<&'a str> {
    let text = matches!(node.role(), Role::Label | Role::Heading).then(|| node.value()).flatten();
    node.label().or(text).or_else(|| {
        let by = nodes.get(&node.labelled_by().first()?.0)?;
        name(by, nodes, steps.checked_sub(1)?)
    })
}

/// Whether a role is one of things that people operate.
fn is_control(role: &str) -> bool {
    !matches!(role, "heading" | "img" | "meter" | "note")
}

/// The ARIA role of what people use or read; `None` for mere containers.
fn aria(role: Role) -> Option<&'static str> {
    Some(match role {
        Role::Button | Role::DefaultButton => "button",
        Role::CheckBox => "checkbox",
        Role::RadioButton => "radio",
        Role::Slider => "slider",
        Role::SpinButton => "spinbutton",
        Role::ComboBox => "combobox",
        Role::TextInput | Role::MultilineTextInput => "textbox",
        Role::Heading => "heading",
        Role::Image | Role::Canvas => "img",
        Role::Meter | Role::ProgressIndicator => "meter",
        Role::Link => "link",
        Role::Label => "note",
        _ => return None,
    })
}
