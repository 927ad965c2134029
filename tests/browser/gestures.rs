//! Pointer, wheel and keys: what they move, and a link that opens the same again.

use serde_json::{Value, json};

use crate::chrome::{Chrome, DESKTOP};
use crate::{keep_picture, on_page, wait_for_points};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

/// The state when the wheel's motion, which egui smooths, has come to rest.
fn at_rest(chrome: &mut Chrome) -> Value {
    loop {
        let views = |state: &Value| [state["plane"].clone(), state["distance"].clone()];
        let before = chrome.state();
        std::thread::sleep(std::time::Duration::from_millis(500));
        let now = chrome.state();
        if views(&now) == views(&before) {
            return now;
        }
    }
}

fn drag(chrome: &mut Chrome, (x, y): (f64, f64), (dx, dy): (f64, f64)) {
    chrome.move_to((x, y));
    chrome.press((x, y), true);
    for step in 1..=8 {
        let share = f64::from(step) / 8.0;
        chrome.drag_to((x + share * dx, y + share * dy));
    }
    chrome.press((x + dx, y + dy), false);
}

#[test]
fn the_plane_is_moved_by_wheel_pointer_and_keys() {
    on_page(DESKTOP, "", |chrome| {
        let yaw = wait_for_points(chrome, 1000)["yaw"].clone();
        let (x, y) = chrome.place_of("Planar domain");
        chrome.move_to((x - 40.0, y - 60.0));
        chrome.scroll((x - 40.0, y - 60.0), -300.0);
        chrome.wait_for_state("s.plane");
        let before = number(&at_rest(chrome)["plane"]["centre"][0]);
        drag(chrome, (x, y), (60.0, 0.0));
        chrome.wait_for_state(&format!("s.plane.centre[0] < {before} - 0.02"));
        // A click gives the plane the keys.
        chrome.press((x, y), true);
        chrome.press((x, y), false);
        at_rest(chrome);
        let before = number(&chrome.state()["plane"]["centre"][0]);
        chrome.key("ArrowRight", "ArrowRight");
        chrome.wait_for_state(&format!("s.plane.centre[0] > {before}"));
        assert_eq!(chrome.state()["yaw"], yaw, "the surface was turned too");
        let before = at_rest(chrome);
        chrome.key("-", "Minus");
        chrome.wait_for_state(&format!("s.plane.halfHeight > 1.1 * {}", before["plane"]["halfHeight"]));
        assert_eq!(chrome.state()["distance"], before["distance"], "the surface was moved too");
        chrome.key("Home", "Home");
        chrome.wait_for_state("s.plane === null");
        // The focus comes over from the surface, and the first arrow comes at once.
        let surface = chrome.place_of("Surface");
        chrome.move_to(surface);
        chrome.press(surface, true);
        chrome.press(surface, false);
        chrome.move_to((x, y));
        chrome.press((x, y), true);
        chrome.press((x, y), false);
        chrome.key("ArrowDown", "ArrowDown");
        chrome.key("-", "Minus");
        chrome.wait_for_state("s.plane?.halfHeight");
        let state = at_rest(chrome);
        assert_eq!((&state["yaw"], &state["distance"]), (&before["yaw"], &before["distance"]));
        chrome.key("-", "Minus");
        chrome.wait_for_state(&format!("s.plane.halfHeight > 1.1 * {}", state["plane"]["halfHeight"]));
    });
}

#[test]
fn the_surface_is_turned_by_pointer_and_keys_and_zoomed_by_the_wheel() {
    on_page(DESKTOP, "", |chrome| {
        let state = wait_for_points(chrome, 1000);
        let (yaw, distance) = (number(&state["yaw"]), number(&state["distance"]));
        let at = chrome.place_of("Surface");
        drag(chrome, at, (80.0, 0.0));
        let turned = number(&chrome.wait_for_state(&format!("s.yaw < {yaw} - 0.2"))["yaw"]);
        chrome.scroll(at, -300.0);
        chrome.wait_for_state(&format!("s.distance < 0.9 * {distance}"));
        at_rest(chrome);
        chrome.key("ArrowLeft", "ArrowLeft");
        chrome.wait_for_state(&format!("s.yaw > {turned} + 0.1"));
        assert_eq!(chrome.state()["up"], "Z");
        chrome.key("u", "KeyU");
        chrome.wait_for_state("s.up === 'Y'");
        chrome.key("Home", "Home");
        chrome.wait_for_state(&format!("Math.abs(s.distance - {distance}) < 1e-6 * {distance}"));
    });
}

#[test]
fn the_obstacle_is_dragged_into_the_view_and_changes_what_is_seen() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        let open = number(&chrome.wait_for_state("s.look")["look"]["surface"]);
        chrome.activate("obstacle");
        let state = chrome.wait_for_state(&format!("s.obstacle && s.look.surface < 0.9 * {open}"));
        let left = number(&state["obstacle"][0][0]);
        let yaw = state["yaw"].clone();
        let at = chrome.place_of("Obstacle: drag it, or move it with I, J, K, L");
        drag(chrome, at, (220.0, 0.0));
        let state = chrome.wait_for_state(&format!(
            "s.obstacle[0][0] > {left} + 0.5 && s.look.surface > {} && s.trail >= 3",
            number(&state["look"]["surface"]) + 0.01
        ));
        assert_eq!(state["yaw"], yaw, "the obstacle's drag turned the surface");
        let left = number(&state["obstacle"][0][0]);
        chrome.key("j", "KeyJ");
        chrome.wait_for_state(&format!("s.obstacle[0][0] < {left}"));
        chrome.activate("local surplus");
        keep_picture(chrome, "page-obstacle.png");
    });
}

#[test]
fn a_link_opens_the_same_again() {
    let all = json!({"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]});
    on_page(DESKTOP, "", |chrome| {
        chrome.call("Browser.grantPermissions", all);
        wait_for_points(chrome, 1000);
        chrome.key("a", "KeyA");
        chrome.wait_for_state("!s.busy && s.pointsOfB === 1000");
        chrome.click("Take away");
        chrome.click("Link with these settings");
        chrome.wait_for_state("s.notice?.done?.includes('clipboard')");
        let link = chrome.evaluate("navigator.clipboard.readText()");
        let link = link.as_str().expect("a link").to_owned();
        assert!(link.contains("#%7B") && link.contains("paper"), "{link}");
        // Only the part behind # differs, so it is opened as from another page.
        chrome.open("about:blank");
        chrome.open(&link);
        chrome.wait_for_state("!s.busy && s.mesh === 'cup' && s.pointsOfB === 1000");
    });
}
