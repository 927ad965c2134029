//! Sources of a field side by side, and the slope of their mean distance, in single precision.

use glam::{DMat3, DVec3, Vec3};

/// So many are looked at side by side.
pub(super) const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Masses that lie together, about a centre, but for where that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    monopole: f32,
    dipole: Vec3,
    /// xx, yy, zz, xy, xz, yz.
    quadrupole: [f32; 6],
    /// Nearer than the root of this it is not seen as a whole.
    near_squared: f32,
}

impl Moments {
    /// A mass of 1 in one place.
    pub(super) const POINT: Self =
        Self { monopole: 1.0, dipole: Vec3::ZERO, quadrupole: [0.0; 6], near_squared: 0.0 };

    /// A cell of mass 1, about its centroid.
    pub(super) fn of_cell(covariance: &DMat3, near: f64) -> Self {
        Self { near_squared: (near * near) as f32, quadrupole: distinct(covariance), ..Self::POINT }
    }

    /// What is left of as much mass as is taken away.
    pub(super) fn of_group(dipole: DVec3, quadrupole: &DMat3) -> Self {
        Self { monopole: 0.0, dipole: dipole.as_vec3(), quadrupole: distinct(quadrupole), near_squared: 0.0 }
    }
}

/// The six different entries of a symmetric matrix.
fn distinct(DMat3 { x_axis: x, y_axis: y, z_axis: z }: &DMat3) -> [f32; 6] {
    [x.x, y.y, z.z, x.y, x.z, y.z].map(|moment| moment as f32)
}

#[derive(Clone, Copy)]
struct Pack {
    centre: [Lanes; 3],
    monopole: Lanes,
    dipole: [Lanes; 3],
    /// xx, yy, zz, xy, xz, yz.
    quadrupole: [Lanes; 6],
    near_squared: Lanes,
}

/// Without mass, and at no place where anything stands.
const NONE: Pack = Pack {
    centre: [[1e9; LANES]; 3],
    monopole: [0.0; LANES],
    dipole: [[0.0; LANES]; 3],
    quadrupole: [[0.0; LANES]; 6],
    near_squared: [0.0; LANES],
};

/// Added to squares of distances, so that a point is in no direction from itself; the unit is about one distance of the points.
const LEAST: f32 = 1e-30;

#[derive(Default)]
pub(super) struct Sources {
    packs: Vec<Pack>,
    count: usize,
}

/// A sum of vectors, lane by lane.
#[derive(Default)]
pub(super) struct Sum([Lanes; 3]);

impl Sum {
    pub(super) fn total(&self) -> DVec3 {
        DVec3::from_array(self.0.map(|lanes| f64::from(lanes.iter().sum::<f32>())))
    }
}

/// Which sources are near.
#[derive(Default)]
pub(super) struct Marks(Vec<[bool; LANES]>);

impl Marks {
    pub(super) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        let of_pack = |(k, marks): (usize, &[bool; LANES])| {
            let marks = *marks;
            (0..LANES).filter(move |&lane| marks[lane]).map(move |lane| k * LANES + lane)
        };
        self.0.iter().enumerate().flat_map(of_pack)
    }
}

impl Sources {
    pub(super) fn push(&mut self, centre: DVec3, moments: &Moments) {
        let lane = self.count % LANES;
        if lane == 0 {
            self.packs.push(NONE);
        }
        self.count += 1;
        let Some(pack) = self.packs.last_mut() else { return };
        let centre = centre.as_vec3().to_array();
        let dipole = moments.dipole.to_array();
        for axis in 0..3 {
            pack.centre[axis][lane] = centre[axis];
            pack.dipole[axis][lane] = dipole[axis];
        }
        for k in 0..6 {
            pack.quadrupole[k][lane] = moments.quadrupole[k];
        }
        pack.monopole[lane] = moments.monopole;
        pack.near_squared[lane] = moments.near_squared;
    }

    /// Moves a source.
    pub(super) fn put(&mut self, k: usize, centre: DVec3) {
        for axis in 0..3 {
            self.packs[k / LANES].centre[axis][k % LANES] = centre[axis] as f32;
        }
    }

    /// Adds the slope of the mean distance to the sources; marks those, and only those, that are too near and leaves them out.
    pub(super) fn add_slope(&self, at: Vec3, sum: &mut Sum, marks: &mut Marks) {
        marks.0.clear();
        for pack in &self.packs {
            marks.0.push(pack.add_slope(at, sum));
        }
    }

    /// Subtracts the unit vectors from the sources.
    pub(super) fn subtract_directions(&self, at: Vec3, sum: &mut Sum) {
        let Vec3 { x, y, z } = at;
        let [right, up, out] = &mut sum.0;
        for Pack { centre: [cx, cy, cz], monopole, .. } in &self.packs {
            for k in 0..LANES {
                let (x, y, z) = (x - cx[k], y - cy[k], z - cz[k]);
                let inverse = monopole[k] / (x * x + y * y + z * z + LEAST).sqrt();
                right[k] -= x * inverse;
                up[k] -= y * inverse;
                out[k] -= z * inverse;
            }
        }
    }
}

impl Pack {
    #[inline]
    fn add_slope(&self, at: Vec3, sum: &mut Sum) -> [bool; LANES] {
        let Self {
            centre: [cx, cy, cz],
            monopole,
            dipole: [dx, dy, dz],
            quadrupole: [xx, yy, zz, xy, xz, yz],
            near_squared,
        } = self;
        let [right, up, out] = &mut sum.0;
        let mut times = [0.0; LANES];
        for k in 0..LANES {
            let (x, y, z) = (at.x - cx[k], at.y - cy[k], at.z - cz[k]);
            let square = x * x + y * y + z * z + LEAST;
            // Of a near one nothing counts, but it has to be a number.
            let inverse = 1.0 / square.max(near_squared[k]).sqrt();
            let (x, y, z) = (x * inverse, y * inverse, z * inverse);
            // To second order the mean distance is m r - D.u + (tr Q - u.Qu) / (2 r), with u the direction, D the dipole and
            // Q the quadrupole.
            let qx = xx[k] * x + xy[k] * y + xz[k] * z;
            let qy = xy[k] * x + yy[k] * y + yz[k] * z;
            let qz = xz[k] * x + yz[k] * y + zz[k] * z;
            let second = 1.5 * (qx * x + qy * y + qz * z) - 0.5 * (xx[k] + yy[k] + zz[k]);
            let straight = monopole[k] + inverse * (dx[k] * x + dy[k] * y + dz[k] * z + inverse * second);
            let far = if square < near_squared[k] { 0.0 } else { 1.0 };
            times[k] = far;
            right[k] += far * (straight * x - inverse * (dx[k] + inverse * qx));
            up[k] += far * (straight * y - inverse * (dy[k] + inverse * qy));
            out[k] += far * (straight * z - inverse * (dz[k] + inverse * qz));
        }
        times.map(|far| far == 0.0)
    }
}
