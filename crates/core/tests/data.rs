//! Options, reports and samples as data (feature `serde`, which `io` has): what is left out has its default, what is unknown is refused,
//! and what was written reads back to the bit.
#![cfg(feature = "io")]

use std::fmt::Debug;

use ldwrap::equalize::{Cameras, EqualizeOptions, ForViews};
use ldwrap::io::points::{Attribute, PointFormat};
use ldwrap::measure::{
    BallOptions, EnergyOptions, HalfSpaceOptions, IntegrationOptions, PatchOptions, SpacingOptions,
    ViewOptions, components,
};
use ldwrap::pipeline::{Options, Request, SampleOrder, Selection};
use ldwrap::segment::SegmentOptions;
use ldwrap::sequence::Sequence;
use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, RepairReport, Sample, SurfaceMesh, SurfacePoint, sample};
use serde::Serialize;
use serde::de::DeserializeOwned;

fn reads_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) -> String {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
    text
}

fn options<T: Serialize + DeserializeOwned + PartialEq + Debug + Default>() {
    let name = std::any::type_name::<T>();
    reads_back(&T::default());
    assert_eq!(serde_json::from_str::<T>("{}").unwrap(), T::default(), "{name}");
    let error = serde_json::from_str::<T>(r#"{"sede": 1}"#).unwrap_err().to_string();
    assert!(error.contains("unknown field `sede`"), "{name}: {error}");
}

#[test]
fn all_options_have_defaults_and_refuse_what_they_do_not_know() {
    options::<Options>();
    options::<CheckOptions>();
    options::<SegmentOptions>();
    options::<EqualizeOptions>();
    options::<ForViews>();
    options::<BallOptions>();
    options::<EnergyOptions>();
    options::<HalfSpaceOptions>();
    options::<IntegrationOptions>();
    options::<PatchOptions>();
    options::<SpacingOptions>();
    options::<ViewOptions>();
}

#[test]
fn a_job_as_a_person_writes_it() {
    let text = r#"{"request": {"count": 500}, "sequence": {"halton": {"bases": [2, 3]}}, "seed": 18446744073709551615,
        "selection": "sequence", "order": "progressive", "segment": {"smallest_share": 0.25},
        "equalize": {"rounds": 3, "for_views": {"cameras": {"cone": {"toward": [0.0, 0.0, 1.0], "angle": 0.5}}}}}"#;
    let expected = Options {
        request: Request::Count(500),
        sequence: Sequence::Halton { bases: [2, 3] },
        seed: u64::MAX,
        selection: Selection::Sequence,
        order: SampleOrder::Progressive,
        segment: SegmentOptions { smallest_share: 0.25, ..SegmentOptions::default() },
        equalize: Some(EqualizeOptions {
            rounds: 3,
            for_views: Some(ForViews {
                cameras: Cameras::Cone { toward: glam::DVec3::Z, angle: 0.5, distance: None },
                ..ForViews::default()
            }),
            ..EqualizeOptions::default()
        }),
        ..Options::default()
    };
    assert_eq!(serde_json::from_str::<Options>(text).unwrap(), expected);
    reads_back(&expected);
    for wrong in [
        r#"{"sequence": {"halton": {"bases": [2, 3], "seed": 1}}}"#,
        r#"{"equalize": {"for_views": {"cameras": {"cone": {"toward": [0, 0, 1], "angle": 1, "form": 2}}}}}"#,
        r#"{"request": {"number": 5}}"#,
    ] {
        assert!(
            serde_json::from_str::<Options>(wrong).unwrap_err().to_string().contains("unknown"),
            "{wrong}"
        );
    }
}

#[test]
fn samples_and_reports_read_back_to_the_bit() {
    let (mesh, repairs) = SurfaceMesh::from_soup(&Shape::Cup.generate(), &CheckOptions::default()).unwrap();
    let samples: Vec<Sample> = sample(&mesh, 40).unwrap();
    let text = reads_back(&samples);
    assert!(text.starts_with(r#"[{"point":{"face":"#), "{text}");
    let points: Vec<SurfacePoint> = samples.iter().map(|s| s.point).collect();
    reads_back(&components(&mesh, &points));
    reads_back::<RepairReport>(&repairs);
}

#[test]
fn formats_and_attributes_have_the_names_of_the_command_line() {
    for format in PointFormat::ALL {
        assert_eq!(reads_back(&format), format!("\"{format}\""));
    }
    for attribute in Attribute::FIXED.into_iter().chain([Attribute::Number("heat".into())]) {
        assert_eq!(reads_back(&attribute), format!("\"{attribute}\""));
    }
    assert!(serde_json::from_str::<Attribute>("\"colour\"").unwrap_err().to_string().contains("colour"));
}
