//! What goes wrong or is given up: the page says so and goes on.

use ldwrap::shapes::Shape;
use serde_json::json;
use xtask::serve::Server;

use crate::chrome::{Chrome, DESKTOP};
use crate::{ONE, built, checked, native_csv, on_page, options, wait_for_points};

#[test]
fn it_opens_again_without_its_server() {
    let Some(built) = built() else { return };
    let _one = ONE.lock().unwrap_or_else(|broken| broken.into_inner());
    let server = Server::start(&built.page, 0).expect("a server");
    let mut chrome = Chrome::start(&built.browser, DESKTOP);
    chrome.open(&server.address());
    wait_for_points(&mut chrome, 1000);
    chrome.wait_for("navigator.serviceWorker.controller");
    server.stop();
    let gone = chrome.evaluate("fetch('no-such-file').then(() => false, () => true)");
    assert_eq!(gone, json!(true), "the server still answers");
    chrome.evaluate("void (window.ldwrap = null)");
    chrome.call("Page.reload", json!({}));
    let state = wait_for_points(&mut chrome, 1000);
    assert_eq!(state["mesh"], "cup");
}

#[test]
fn workers_that_break_are_replaced() {
    on_page(DESKTOP, "", |chrome| {
        wait_for_points(chrome, 1000);
        chrome.wait_for_state("s.verdicts === 7");
        chrome.break_workers();
        let state = chrome.wait_for_state("s.notice?.problem");
        assert!(state["notice"]["problem"].as_str().is_some_and(|t| t.contains("memory")), "{state}");
        assert_eq!((&state["mesh"], &state["points"]), (&json!("cup"), &json!(1000)));
        // The new workers have the old one's points, and make others.
        chrome.click("Take away");
        chrome.click("Points, CSV");
        let taken = chrome.downloaded("cup-points.csv");
        assert!(taken == native_csv(&checked(&Shape::Cup.generate()), &options(1000)), "other points");
        chrome.activate("equalize");
        chrome.wait_for_state("!s.busy && s.notice?.done && s.points === 1000 && s.verdicts === 7");
    });
}

#[test]
fn long_work_shows_its_progress_and_can_be_stopped() {
    // B asks for so many points that there is time to stop it.
    let link = json!({"shape": "cup", "other": {"request": {"count": 2_000_000}}}).to_string();
    let fragment: String = link.bytes().map(|byte| format!("%{byte:02X}")).collect();
    on_page(DESKTOP, &format!("#{fragment}"), |chrome| {
        let state = chrome.wait_for_state("s.points === 1000 && s.busy && s.stage");
        assert_eq!(state["pointsOfB"], json!(null));
        // The page is not frozen meanwhile.
        let before = state["yaw"].clone();
        chrome.key("ArrowLeft", "ArrowLeft");
        chrome.wait_for_state(&format!("s.busy && s.yaw !== {before}"));
        chrome.click("Stop");
        let state = chrome.wait_for_state("!s.busy && s.notice?.done");
        assert!(state["notice"]["done"].as_str().is_some_and(|t| t.contains("stopped")), "{state}");
        assert_eq!((&state["points"], &state["pointsOfB"]), (&json!(1000), &json!(null)));
        // A's points are still there to be taken, though their worker was ended.
        chrome.click("Take away");
        chrome.click("Points, CSV");
        let taken = chrome.downloaded("cup-points.csv");
        assert!(taken == native_csv(&checked(&Shape::Cup.generate()), &options(1000)), "other points");
    });
}
