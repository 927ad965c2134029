//! The whole pipeline on any soup: exactly the points that were asked for, on the surface, or an error that says why.

use arbitrary::Arbitrary;
use glam::DVec3;
use ldwrap::equalize::EqualizeOptions;
use ldwrap::pipeline::{Options, OptionsError, Request, SampleOrder, Selection, run};
use ldwrap::segment::SegmentOptions;
use ldwrap::sequence::Sequence;
use ldwrap::shapes::Shape;
use ldwrap::{CheckOptions, PolygonSoup, Silent, SurfaceMesh};

use crate::checks::{check_samples, check_segmentation, check_strips};

/// How many faces a shape has, and how many points are made, at most: many small cases find more than a few large ones.
const MOST: u8 = 64;

/// A soup and what is asked for: a shape, or nothing, changed in places, and polygons of any corners beside it.
#[derive(Arbitrary, Debug)]
pub struct Case {
    base: Base,
    moved: Vec<(u16, u8, Coordinate)>,
    vertices: Vec<[Coordinate; 3]>,
    polygons: Vec<Vec<u8>>,
    /// Corners replaced by any index.
    wrong: Option<(u16, u32)>,
    /// All coordinates are multiplied by two to the power of the first, then moved by the second.
    unit: i8,
    shift: Option<Coordinate>,
    count: u8,
    seed: u8,
    how: How,
}

#[derive(Arbitrary, Debug)]
enum Base {
    Nothing,
    Shape { which: u8, faces: u8 },
}

/// A number of one of the kinds that go wrong.
#[derive(Arbitrary, Clone, Copy, Debug)]
enum Coordinate {
    Whole(i8),
    Fraction(i16),
    /// Near a whole number.
    Beside(i8, i8),
    Power {
        negative: bool,
        exponent: i8,
    },
    Bits(u64),
}

impl Coordinate {
    fn value(self) -> f64 {
        match self {
            Self::Whole(value) => value.into(),
            Self::Fraction(value) => f64::from(value) / 4096.0,
            Self::Beside(value, steps) => f64::from(value) * (1.0 + f64::from(steps) * f64::EPSILON),
            Self::Power { negative, exponent } => {
                let value = 2f64.powi(2 * i32::from(exponent));
                if negative { -value } else { value }
            }
            Self::Bits(bits) => f64::from_bits(bits),
        }
    }
}

#[derive(Arbitrary, Debug)]
enum How {
    Default,
    Equalized,
    Progressive,
    /// As in the paper.
    Sequence,
    Extensible,
    /// Nothing is almost flat.
    EveryEdge,
}

impl Case {
    fn soup(&self) -> PolygonSoup {
        let mut soup = match self.base {
            Base::Nothing => PolygonSoup::default(),
            Base::Shape { which, faces } => {
                Shape::ALL[which as usize % Shape::ALL.len()].generate_about(u32::from(faces % MOST))
            }
        };
        let own = soup.positions.len();
        soup.positions.extend(self.vertices.iter().map(|v| DVec3::from_array(v.map(Coordinate::value))));
        for &(vertex, axis, value) in &self.moved {
            if own > 0 {
                soup.positions[vertex as usize % own][axis as usize % 3] = value.value();
            }
        }
        for polygon in &self.polygons {
            let vertices = soup.positions.len().max(1);
            // Counted from the end, so that they reach the vertices beside the shape.
            let corners: Vec<u32> =
                polygon.iter().map(|&corner| (vertices - 1 - corner as usize % vertices) as u32).collect();
            soup.push_polygon(&corners);
        }
        if let Some((corner, index)) = self.wrong {
            let corners = soup.corners.len().max(1);
            if let Some(corner) = soup.corners.get_mut(corner as usize % corners) {
                *corner = index;
            }
        }
        let (unit, shift) = (2f64.powi(self.unit.into()), self.shift.map_or(0.0, Coordinate::value));
        for position in &mut soup.positions {
            *position = *position * unit + shift;
        }
        soup
    }

    fn count(&self) -> usize {
        usize::from(self.count % MOST)
    }

    fn options(&self) -> Options {
        let options =
            Options { request: Request::Count(self.count()), seed: self.seed.into(), ..Options::default() };
        match self.how {
            How::Default => options,
            How::Equalized => Options { equalize: Some(EqualizeOptions::default()), ..options },
            How::Progressive => Options { order: SampleOrder::Progressive, ..options },
            How::Sequence => Options { selection: Selection::Sequence, ..options },
            How::Extensible => {
                Options { selection: Selection::Extensible, sequence: Sequence::R2, ..options }
            }
            How::EveryEdge => {
                let segment = SegmentOptions { flatness_angle: 0.0, ..SegmentOptions::default() };
                Options { segment, ..options }
            }
        }
    }
}

/// Runs a case.
///
/// # Panics
/// If a promise is broken.
pub fn pipeline(case: &Case) {
    let soup = case.soup();
    let options = case.options();
    let mesh = match SurfaceMesh::from_soup(&soup, &CheckOptions::default()) {
        Ok((mesh, _)) => mesh,
        Err(error) => {
            let message = error.to_string();
            assert!(message.len() > 10 && !message.contains(|c: char| c.is_control()), "{message:?}");
            return;
        }
    };
    let run = match run(&mesh, &options, &Silent) {
        Ok(run) => run,
        Err(OptionsError::OutOfRange { name: "count", .. }) if case.count() == 0 => return,
        // Needles may need a larger domain than memory is spent on, which is said.
        Err(OptionsError::TooMany { .. }) => return,
        Err(error) => panic!("{error}"),
    };
    assert_eq!(run.samples.len(), case.count(), "exactly as many as were asked for");
    let (low, high) = mesh.bounds();
    let rounding = 1e-9 * mesh.diagonal() + 4.0 * f64::EPSILON * low.abs().max(high.abs()).max_element();
    for sample in &run.samples {
        let weights = sample.point.barycentric;
        assert!(weights.iter().all(|w| (0.0..=1.0).contains(w)), "{weights:?}");
        let place = mesh.locate(&sample.point);
        assert!(place.is_finite() && place.cmpge(low - rounding).all() && place.cmple(high + rounding).all());
        assert!(sample.place.is_finite());
    }
    let irregularity = run.irregularity();
    assert!(irregularity.exact >= 0.0 && irregularity.bound.is_finite(), "{irregularity:?}");
    check_segmentation("case", &mesh, &run.segmentation);
    // The invariants of lengths hold to the rounding of coordinates.
    if low.abs().max(high.abs()).max_element() <= 1e4 * mesh.diagonal() {
        check_strips("case", &mesh, &run.segmentation, &run.strips);
        check_samples("case", &mesh, &run.strips, &run.domain, &run.samples);
    }
}
