//! A sample figure: a patch grown on the surface, and the parts it falls into when unfolded (paper, figure 2).

use ldwrap::{FaceId, HalfedgeId, SurfaceMesh};
use serde::{Deserialize, Serialize};

use crate::scene::{RunScene, Side};

/// A grown patch with its shares and parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// The triangle it grew from.
    pub seed: u32,
    /// How many rings it grew.
    pub rings: u32,
    /// Its triangles, with the number of the unfolded part that holds each.
    pub faces: Vec<(u32, u32)>,
    /// The decomposition degree f_d: into how many connected parts it falls in the plane.
    pub degree: u32,
    /// Its share of the area.
    pub area_share: f64,
    /// Its share of the points.
    pub point_share: f64,
}

/// Grows a patch of `rings` rings of neighbours around a triangle and unfolds it.
pub fn grow(mesh: &SurfaceMesh, run: &RunScene, seed: u32, rings: u32) -> Figure {
    let mut part_of: Vec<Option<u32>> = vec![None; mesh.face_count()];
    let mut inside = vec![false; mesh.face_count()];
    let mut order = vec![FaceId(seed)];
    inside[seed as usize] = true;
    let mut ring = 0..1;
    for _ in 0..rings {
        let end = order.len();
        for index in ring {
            for twin in neighbours(mesh, order[index]) {
                let face = twin.face();
                if !inside[face.index()] {
                    inside[face.index()] = true;
                    order.push(face);
                }
            }
        }
        ring = end..order.len();
    }
    let mut degree = 0;
    for &start in &order {
        if part_of[start.index()].is_some() {
            continue;
        }
        part_of[start.index()] = Some(degree);
        let mut stack = vec![start];
        while let Some(face) = stack.pop() {
            for corner in 0..3 {
                let side = HalfedgeId::of(face, corner);
                // A closed cut leaves its two sides together in the plane: it parts nothing.
                if run.sides[side.0 as usize] == Side::Open {
                    continue;
                }
                if let Some(twin) = mesh.topology().twin(side)
                    && inside[twin.face().index()]
                    && part_of[twin.face().index()].is_none()
                {
                    part_of[twin.face().index()] = Some(degree);
                    stack.push(twin.face());
                }
            }
        }
        degree += 1;
    }
    let area: f64 = order.iter().map(|f| mesh.face_area(*f)).sum();
    let held = run.points.iter().filter(|p| inside[p.face as usize]).count();
    Figure {
        seed,
        rings,
        faces: order.iter().filter_map(|f| Some((f.0, part_of[f.index()]?))).collect(),
        degree,
        area_share: area / mesh.area(),
        point_share: held as f64 / run.points.len().max(1) as f64,
    }
}

fn neighbours(mesh: &SurfaceMesh, face: FaceId) -> impl Iterator<Item = HalfedgeId> {
    (0..3).filter_map(move |corner| mesh.topology().twin(HalfedgeId::of(face, corner)))
}
