//! Pictures of small meshes, by what must be seen in them.

use glam::{DVec2, DVec3, dvec2, dvec3};
use ldwrap::domain::PlanarDomain;
use ldwrap::geometry::triangle;
use ldwrap::unfold::{BorderEdge, FacePlace, Strip, Strips, Twin};
use ldwrap::{
    CheckOptions, FaceId, HalfedgeId, Origin, PolygonSoup, Sample, StripId, SurfaceMesh, SurfacePoint,
};

use super::layout::shelves;
use super::palette::{MOVED, PAPER, Rgb, strip_colours};
use super::{PreviewOptions, preview_png, strips_svg};

fn mesh(positions: &[DVec3], faces: &[[u32; 3]]) -> SurfaceMesh {
    let mut soup = PolygonSoup { positions: positions.to_vec(), ..PolygonSoup::default() };
    for face in faces {
        soup.push_polygon(face);
    }
    SurfaceMesh::from_soup(&soup, &CheckOptions { turn_outward: false }).expect("a valid mesh").0
}

/// A square of side 2 that faces the viewer at this height towards him, as two faces.
fn square_at(height: f64) -> Vec<DVec3> {
    let toward = dvec3(0.55, 0.36, 0.76).normalize();
    let right = DVec3::Y.cross(toward).normalize();
    let up = toward.cross(right);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| x * right + y * up + height * toward)
        .to_vec()
}

/// Every face a strip of its own.
fn single_faces(mesh: &SurfaceMesh) -> Strips {
    let topology = mesh.topology();
    let strips = topology
        .face_ids()
        .map(|face| {
            let [a, b, c] = mesh.triangle(face);
            let (length, x, y) = triangle::flatten(a, b, c);
            let vertices =
                [dvec2(0.0, 0.0), dvec2(length, 0.0), dvec2(x, y)].map(|p| p - dvec2(x.min(0.0), 0.0));
            let border = (0..3)
                .map(|c| {
                    let halfedge = HalfedgeId::of(face, c);
                    let twin = topology
                        .twin(halfedge)
                        .map_or(Twin::MeshBorder, |t| Twin::OtherStrip(StripId(t.face().0)));
                    BorderEdge { halfedge, from: c as u32, to: (c as u32 + 1) % 3, twin }
                })
                .collect();
            Strip {
                faces: vec![face],
                corners: vec![[0, 1, 2]],
                vertices: vertices.to_vec(),
                border,
                loops: std::iter::once(0..3).collect(),
                area: mesh.face_area(face),
                extent: vertices.iter().copied().fold(DVec2::ZERO, DVec2::max),
            }
        })
        .collect();
    let places = topology.face_ids().map(|f| FacePlace { strip: StripId(f.0), index: 0 }).collect();
    Strips { strips, places }
}

fn sample(strips: &Strips, face: u32, barycentric: [f64; 3], origin: Origin) -> Sample {
    let [a, b, c] = strips.strips[face as usize].triangle(0);
    let place = a * barycentric[0] + b * barycentric[1] + c * barycentric[2];
    Sample { point: SurfacePoint { face: FaceId(face), barycentric }, strip: StripId(face), place, origin }
}

struct Picture {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Picture {
    fn read(file: &[u8]) -> Self {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a PNG file");
        let mut bytes = vec![0; reader.output_buffer_size().expect("fits")];
        let info = reader.next_frame(&mut bytes).expect("a whole picture");
        Self { width: info.width as usize, height: info.height as usize, bytes }
    }

    fn pixel(&self, x: usize, y: usize) -> Rgb {
        let at = (y * self.width + x) * 3;
        Rgb([self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]])
    }

    fn count(&self, colour: Rgb) -> usize {
        self.bytes.chunks(3).filter(|p| *p == colour.0).count()
    }
}

const SMALL: PreviewOptions = PreviewOptions { width: 200, height: 160 };

/// Whether two colours differ in brightness only: the same hue, up to rounding.
fn same_hue(a: Rgb, b: Rgb) -> bool {
    let unit = |c: Rgb| {
        let [r, g, b] = c.0.map(f64::from);
        dvec3(r, g, b).normalize()
    };
    unit(a).distance(unit(b)) < 0.02
}

#[test]
fn pixels_have_the_colour_of_their_strip() {
    let mesh = mesh(&square_at(0.0), &[[0, 1, 2], [0, 2, 3]]);
    let strips = single_faces(&mesh);
    let picture = Picture::read(&preview_png(&mesh, &strips, &[], &SMALL));
    assert_eq!((picture.width, picture.height), (200, 160));
    let colours = strip_colours(&strips);
    assert_ne!(colours[0], colours[1]);
    // Below the diagonal from the lower left the first face, above it the second.
    assert!(same_hue(picture.pixel(110, 90), colours[0]), "{}", picture.pixel(110, 90));
    assert!(same_hue(picture.pixel(90, 70), colours[1]), "{}", picture.pixel(90, 70));
    // The square fills 92% of the height, and nothing else is drawn.
    assert_eq!(picture.pixel(2, 80), PAPER);
    assert_eq!(picture.pixel(100, 2), PAPER);
    let drawn = picture.width * picture.height - picture.count(PAPER);
    let side = 0.92 * 160.0;
    assert!((drawn as f64 - side * side).abs() < 4.0 * side, "{drawn} pixels");
}

#[test]
fn what_stands_along_z_is_seen_upright() {
    let seen = |turn: fn(DVec3) -> DVec3| {
        let mesh = pyramid(turn);
        Picture::read(&preview_png(&mesh, &single_faces(&mesh), &[], &SMALL)).bytes
    };
    // The turn that takes y up and z in front to z up and -y in front shows the same.
    assert_eq!(seen(|p| p), seen(|p| dvec3(p.x, -p.z, p.y)));
}

#[test]
fn hidden_points_are_not_drawn() {
    // A square in front of another one.
    let positions = [square_at(0.0), square_at(1.0)].concat();
    let mesh = mesh(&positions, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    let strips = single_faces(&mesh);
    let third = [1.0 / 3.0; 3];
    let plain = Picture::read(&preview_png(&mesh, &strips, &[], &SMALL));
    let behind = [sample(&strips, 0, third, Origin::Projected)];
    let in_front = [sample(&strips, 2, third, Origin::Projected)];
    let hidden = Picture::read(&preview_png(&mesh, &strips, &behind, &SMALL));
    assert_eq!(hidden.bytes, plain.bytes);
    let shown = Picture::read(&preview_png(&mesh, &strips, &in_front, &SMALL));
    assert!(shown.count(MOVED) > 0);
}

#[test]
fn the_far_side_of_a_sheet_hides_its_points() {
    // So thin that its sides are as deep as each other: only that which faces the viewer shows its points.
    let positions = [square_at(0.0), square_at(-1e-4)].concat();
    let mesh = mesh(&positions, &[[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]]);
    let strips = single_faces(&mesh);
    for (face, seen) in [(0, true), (1, true), (2, false), (3, false)] {
        let one = [sample(&strips, face, [0.2, 0.3, 0.5], Origin::Projected)];
        let picture = Picture::read(&preview_png(&mesh, &strips, &one, &SMALL));
        assert_eq!(picture.count(MOVED) > 0, seen, "face {face}");
    }
}

#[test]
fn a_picture_of_one_pixel_is_a_picture() {
    let mesh = mesh(&square_at(0.0), &[[0, 1, 2], [0, 2, 3]]);
    let file = preview_png(&mesh, &single_faces(&mesh), &[], &PreviewOptions { width: 0, height: 1 });
    let picture = Picture::read(&file);
    assert_eq!((picture.width, picture.height), (1, 1));
}

/// The names of the elements that are opened, after a check that every one is closed in order.
fn elements(svg: &str) -> Vec<&str> {
    let mut open = Vec::new();
    let mut all = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (inside, text) = tag.split_once('>').expect("every tag ends");
        assert!(!text.contains('>'));
        assert!(inside.matches('"').count().is_multiple_of(2), "quotes in {inside}");
        if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        let name = inside.split([' ', '/']).next().unwrap_or_default();
        all.push(name);
        if !inside.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} not closed");
    all
}

/// The sides of a pyramid that stands along y, turned.
fn pyramid(turn: fn(DVec3) -> DVec3) -> SurfaceMesh {
    let positions = [
        dvec3(-1.0, 0.0, 1.0),
        dvec3(1.0, 0.0, 1.0),
        dvec3(1.0, 0.0, -1.0),
        dvec3(-1.0, 0.0, -1.0),
        dvec3(0.0, 1.5, 0.0),
    ];
    mesh(&positions.map(turn), &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

#[test]
fn the_strips_picture_has_a_group_a_strip_and_a_dot_a_point() {
    let mesh = pyramid(|p| p);
    let strips = single_faces(&mesh);
    let mut samples: Vec<_> = (0..4)
        .flat_map(|face| {
            [[0.2, 0.3, 0.5], [0.4, 0.4, 0.2]].map(|b| sample(&strips, face, b, Origin::Wrapped))
        })
        .collect();
    samples[3].origin = Origin::Projected;
    // Wherever the strips lie in the domain, the points lie at the same places in them.
    let domain = PlanarDomain { side: 10.0, offsets: vec![dvec2(1.0, 2.0); 4] };
    let at_origin = PlanarDomain { side: 10.0, offsets: vec![DVec2::ZERO; 4] };
    let moved: Vec<_> = samples.iter().map(|s| Sample { place: s.place + dvec2(1.0, 2.0), ..*s }).collect();
    let svg = strips_svg(&strips, &domain, &moved, 0.0);
    assert_eq!(svg, strips_svg(&strips, &at_origin, &samples, 0.0));

    let names = elements(&svg);
    assert_eq!(names[0], "svg");
    assert_eq!(names.iter().filter(|n| **n == "circle").count(), 8);
    assert_eq!(svg.matches(r#"class="strip""#).count(), 4);
    for colour in strip_colours(&strips) {
        assert_eq!(svg.matches(&format!(r#"<path fill="{colour}""#)).count(), 1);
    }
    assert!(svg.contains("4 strips of 4 triangles"));
    assert!(svg.contains("8 points"));
    let pink = svg.split(&format!(r#"fill="{MOVED}" stroke"#)).nth(1).expect("a group of moved points");
    assert_eq!(pink.split("</g>").next().map(|g| g.matches("<circle").count()), Some(1));
}

#[test]
fn closed_borders_are_not_drawn() {
    let mesh = pyramid(|p| p);
    let strips = single_faces(&mesh);
    let domain = PlanarDomain { side: 10.0, offsets: vec![DVec2::ZERO; 4] };
    let open = |tolerance| {
        strips_svg(&strips, &domain, &[], tolerance).matches(r#"stroke-linecap="round" d="M"#).count()
    };
    assert_eq!((open(0.0), open(f64::INFINITY)), (4, 0));
}

#[test]
fn a_picture_of_nothing_is_well_formed() {
    let svg = strips_svg(
        &Strips { strips: Vec::new(), places: Vec::new() },
        &PlanarDomain { side: 1.0, offsets: Vec::new() },
        &[],
        0.1,
    );
    elements(&svg);
    assert!(svg.contains("0 strips of 0 triangles"));
}

#[test]
fn shelves_keep_boxes_apart_and_inside() {
    let sizes: Vec<DVec2> =
        (0..60).map(|i| dvec2(f64::from(i * 7 % 11 + 1), f64::from(i * 5 % 13 + 1))).collect();
    let layout = shelves(&sizes, 0.01);
    let boxes: Vec<_> = layout.corners.iter().zip(&sizes).map(|(&c, &s)| (c, c + s)).collect();
    for (i, a) in boxes.iter().enumerate() {
        assert!(a.0.min_element() >= 0.0 && a.1.cmple(layout.size).all());
        for b in &boxes[..i] {
            let apart = a.1.cmplt(b.0) | b.1.cmplt(a.0);
            assert!(apart.any(), "{a:?} meets {b:?}");
        }
    }
    let filled = sizes.iter().map(|s| s.x * s.y).sum::<f64>() / (layout.size.x * layout.size.y);
    assert!(filled > 0.6, "only {filled} filled");
}

#[test]
fn neighbours_never_share_a_colour_and_few_strips_share_none() {
    let mesh = pyramid(|p| p);
    let strips = single_faces(&mesh);
    let colours = strip_colours(&strips);
    for (i, colour) in colours.iter().enumerate() {
        assert!(!colours[..i].contains(colour));
        assert_ne!(*colour, MOVED);
    }
    // A hundred squares side by side: more strips than colours.
    let columns = 50;
    let positions: Vec<_> =
        (0..2 * (columns + 1)).map(|i| dvec3(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
    let faces: Vec<_> = (0..columns)
        .flat_map(|i| {
            let a = 2 * i as u32;
            [[a, a + 2, a + 3], [a, a + 3, a + 1]]
        })
        .collect();
    let ribbon = self::mesh(&positions, &faces);
    let strips = single_faces(&ribbon);
    let colours = strip_colours(&strips);
    for (i, strip) in strips.strips.iter().enumerate() {
        for edge in &strip.border {
            if let Twin::OtherStrip(other) = edge.twin {
                assert_ne!(colours[i], colours[other.index()]);
            }
        }
    }
}
