//! What points carry, read back from the files byte by byte.

use std::io::Write;
use std::process::Command;

use crate::common::{Folder, OCTAHEDRON};

/// A PNG picture of 2 x 2 texels: red, green; blue, white.
fn picture() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&[255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]).expect("texels");
    writer.finish().expect("a picture");
    bytes
}

/// A square of 2 x 2 under the picture, all of it in the middles of texels: four quads, each with one place.
fn textured() -> Folder {
    let folder = Folder::new();
    folder.write("t.png", picture());
    folder.write("m.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd t.png\n");
    let mut obj =
        String::from("mtllib m.mtl\nusemtl paint\nvt .25 .25\nvt .75 .25\nvt .25 .75\nvt .75 .75\n");
    for y in 0..3 {
        for x in 0..3 {
            obj += &format!("v {x} {y} 0\n");
        }
    }
    for (quad, (x, y)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
        let (uv, first) = (quad + 1, 3 * y + x + 1);
        obj += &format!(
            "o quad{quad}\nf {first}/{uv} {}/{uv} {}/{uv} {}/{uv}\n",
            first + 1,
            first + 4,
            first + 3
        );
    }
    folder.write("square.obj", obj);
    folder
}

/// The texel over a place of the square.
fn texel(x: f64, y: f64) -> [u8; 3] {
    match (x < 1.0, y < 1.0) {
        (true, true) => [0, 0, 255],
        (false, true) => [255, 255, 255],
        (true, false) => [255, 0, 0],
        (false, false) => [0, 255, 0],
    }
}

#[test]
fn points_of_a_textured_square() {
    let folder = textured();
    folder
        .run("wrap square.obj -n 64 -q -o p.csv --attributes color,material,part,uv,polygon,cell-area")
        .ok();
    let text = folder.text("p.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x,y,z,red,green,blue,alpha,material,part,u,v,polygon,cell_area"));
    let mut area = 0.0;
    let mut quads = [0; 4];
    for line in lines {
        let words: Vec<&str> = line.split(',').collect();
        let number = |i: usize| words[i].parse::<f64>().expect("a number");
        let (x, y) = (number(0), number(1));
        let [r, g, b] = texel(x, y);
        assert_eq!(words[3..8], [&r.to_string(), &g.to_string(), &b.to_string(), "255", "paint"], "{line}");
        let quad = usize::from(x >= 1.0) + 2 * usize::from(y >= 1.0);
        assert_eq!((words[8], words[11]), (&*format!("quad{quad}"), &*quad.to_string()), "{line}");
        // Weighted with barycentric coordinates, whose sum is 1 to rounding.
        let uv = [x, y].map(|place| 0.25 + 0.5 * f64::from(place >= 1.0));
        assert!((number(9) - uv[0]).abs() < 1e-15 && (number(10) - uv[1]).abs() < 1e-15, "{line}");
        area += number(12);
        quads[quad] += 1;
    }
    assert!((area - 4.0).abs() < 1e-9, "{area}");
    assert_eq!(quads.iter().sum::<usize>(), 64);

    // The properties that other programs look for, each where the head says.
    folder.run("wrap square.obj -n 64 -q -o p.ply --attributes smooth-normal,color,uv").ok();
    let bytes = folder.read("p.ply");
    let end = b"end_header\n";
    let start = bytes.windows(end.len()).position(|w| w == end).expect("a head") + end.len();
    let head = String::from_utf8_lossy(&bytes[..start]);
    let properties: Vec<&str> = head.lines().filter_map(|line| line.strip_prefix("property ")).collect();
    assert_eq!(
        properties,
        [
            "double x",
            "double y",
            "double z",
            "float nx",
            "float ny",
            "float nz",
            "uchar red",
            "uchar green",
            "uchar blue",
            "uchar alpha",
            "float s",
            "float t"
        ]
    );
    let row = 3 * 8 + 3 * 4 + 4 + 2 * 4;
    assert_eq!(bytes.len() - start, 64 * row);
    for point in bytes[start..].chunks_exact(row) {
        let double = |i: usize| f64::from_le_bytes(point[i..i + 8].try_into().expect("eight bytes"));
        assert_eq!(point[36..39], texel(double(0), double(8)));
        assert_eq!(point[32..36], 1f32.to_le_bytes(), "nz");
    }
}

#[test]
fn all_that_there_is_in_every_format() {
    let folder = textured();
    for format in ["ply", "ply-ascii", "xyz", "csv", "npy", "npz", "json", "obj", "glb"] {
        folder.run(&format!("wrap square.obj -n 30 -q -o p --format {format} --attributes all")).ok();
        let measured = folder.run(&format!("measure square.obj p --points-format {format} --json -q")).ok();
        assert_eq!(measured.json()["points"]["count"], 30, "{format}");
    }
    folder.run("wrap square.obj -n 30 -q -o p.json --attributes all").ok();
    let json = folder.json("p.json");
    let keys: Vec<&String> = json[0].as_object().expect("a point").keys().collect();
    assert_eq!(keys.len(), 14, "{keys:?}");
    assert_eq!((&json[0]["material"], &json[0]["normal"][2]), (&"paint".into(), &1.0.into()));
}

#[test]
fn only_some_materials_and_parts() {
    let folder = textured();
    folder
        .run(
            "wrap square.obj -n 40 -q -o p.csv --attributes part,polygon --only part:quad1 --only part:quad2",
        )
        .ok();
    let text = folder.text("p.csv");
    let of = |end: &str| text.lines().filter(|line| line.ends_with(end)).count();
    assert_eq!((of("quad1,1"), of("quad2,2"), text.lines().count()), (20, 20, 41));
    folder
        .run("wrap square.obj -n 40 -o p.csv --only part:quad9")
        .failed(&["part \"quad9\"", "quad0, quad1, quad2"]);
    folder.run("wrap square.obj -o p.csv --only quad1").refused(&["material:NAME or part:NAME"]);
}

#[test]
fn weights_by_color_and_property() {
    let folder = textured();
    // Blue is in one quad, and in the white one: half of the square, evenly.
    folder.run("wrap square.obj -n 100 -q -o p.csv --attributes part --weights-by blue").ok();
    let text = folder.text("p.csv");
    let of = |end: &str| text.lines().filter(|line| line.ends_with(end)).count();
    assert_eq!(of("quad2") + of("quad3"), 0);
    assert!((49..=51).contains(&of("quad0")), "{}", of("quad0"));
    // A property that grows from 0 to 1 along x: the mean of x is 2/3.
    let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    folder.write("heat.ply", format!("{head}0 0 0 0\n1 0 0 1\n1 1 0 1\n0 1 0 0\n4 0 1 2 3\n"));
    folder.run("wrap heat.ply -n 400 -q -o p.csv --weights-by property:heat --attributes property:heat").ok();
    let text = folder.text("p.csv");
    let heat: Vec<f64> =
        text.lines().skip(1).map(|l| l.rsplit(',').next().unwrap_or("").parse().expect("heat")).collect();
    let mean = heat.iter().sum::<f64>() / heat.len() as f64;
    assert!((mean - 2.0 / 3.0).abs() < 0.01, "{mean}");
    folder.run("wrap heat.ply -q -o p.csv --weights-by red").failed(&["heat.ply", "has no color"]);
}

#[test]
fn weights_follow_a_texture_inside_large_faces() {
    // One quad under a picture of 32 x 32 texels, white but for a black disc.
    let folder = Folder::new();
    let size = 32_u32;
    let from_middle = |x: f64, y: f64| glam::DVec2::new(x - 0.3, y - 0.6).length();
    let is_black = |x: f64, y: f64| from_middle(x, y) < 0.25;
    let mut texels = Vec::new();
    for row in 0..size {
        for column in 0..size {
            let at = |index: u32| (f64::from(index) + 0.5) / f64::from(size);
            texels.push(if is_black(at(column), 1.0 - at(row)) { 0 } else { 255 });
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size, size);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("a picture");
    folder.write("t.png", &bytes);
    folder.write("m.mtl", "newmtl paint\nmap_Kd t.png\n");
    folder.write(
        "quad.obj",
        "mtllib m.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
         f 1/1 2/2 3/3 4/4\n",
    );
    let wrap = "wrap quad.obj -n 800 -q -o p.csv --weights-by luminance --report r.json";
    folder.run(&format!("{wrap} --attributes face,polygon,barycentric,uv,cell-area --preview p.png")).ok();
    let text = folder.text("p.csv");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|word| word.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.len(), 800);
    // The rim of the disc is grey, one texel wide.
    let deep = rows.iter().filter(|row| from_middle(row[0], row[1]) < 0.21).count();
    assert_eq!(deep, 0, "points in the black");
    for row in &rows {
        let &[x, y, _, face, polygon, .., u, v, area] = &row[..] else { panic!("{row:?}") };
        // The faces are those of the file, two triangles, however finely they were cut.
        assert!((face == 0.0 || face == 1.0) && polygon == 0.0, "{row:?}");
        assert!((u - x).abs() < 1e-12 && (v - y).abs() < 1e-12 && area > 0.0, "{row:?}");
    }
    assert_eq!(folder.json("r.json")["mesh"]["faces"], 2);
    // The white part is evenly covered: the right half, without the disc but for a sliver, has its share.
    let right = rows.iter().filter(|row| row[0] > 0.55).count() as f64;
    let due = 0.45 / (1.0 - std::f64::consts::PI * 0.0625) * 800.0;
    assert!((right - due).abs() < 0.03 * due, "{right} of {due}");
}

/// Properties of a PLY file may be called as what points carry anyway.
#[test]
fn names_that_are_taken() {
    let folder = Folder::new();
    let numbers = ["b0", "Face", "strip", "normal", "property_b0", "heat"];
    let properties: String = numbers.iter().map(|name| format!("property float {name}\n")).collect();
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n{properties}\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0 1 2 3 4 5 6\n1 0 0 1 2 3 4 5 6\n0 1 0 1 2 3 4 5 6\n3 0 1 2\n"
    );
    folder.write("taken.ply", text);
    let wrap = |rest: &str| folder.run(&format!("wrap taken.ply -n 4 -q {rest}")).ok();
    wrap("-o p.csv --attributes all");
    let written = folder.text("p.csv");
    let (head, rows) = written.split_once('\n').expect("a head");
    let all = "property_property_b0,property_Face,property_strip,property_normal,property_b0,heat";
    assert!(head.ends_with(&format!(",{all}")), "{head}");
    for row in rows.lines() {
        // The same at all corners, but for the rounding of three shares of it.
        let values: Vec<f64> = row.rsplit(',').take(6).map(|value| value.parse().expect(row)).collect();
        let due = [6.0, 5.0, 4.0, 3.0, 2.0, 1.0];
        assert!(values.iter().zip(due).all(|(value, due)| (value - due).abs() < 1e-14 * due), "{row}");
    }
    for format in ["ply", "npz", "json", "glb", "xyz"] {
        wrap(&format!("-o p.{format} --attributes all"));
    }
    assert!(folder.text("p.json").contains("\"property_normal\""));
    // Alone they keep their names.
    wrap("-o q.csv --attributes property:b0,property:Face");
    assert!(folder.text("q.csv").starts_with("x,y,z,b0,Face\n"));
}

/// As in CSV and JSON.
#[test]
fn names_in_ply_are_utf_8() {
    let folder = Folder::new();
    let named = OCTAHEDRON.replace("f 1 3 5", "usemtl \u{dc}ber Lack\no \u{90e8}\u{54c1}\nf 1 3 5");
    folder.write("named.obj", named);
    for format in ["ply", "ply-ascii"] {
        let out = format!("-n 20 -q -o p.ply --format {format} --attributes material,part");
        folder.run(&format!("wrap named.obj {out}")).ok();
        let bytes = folder.read("p.ply");
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(400)]).into_owned();
        assert!(head.contains("\ncomment material 0 \u{dc}ber Lack\n"), "{head}");
        assert!(head.contains("\ncomment part 0 \u{90e8}\u{54c1}\n"), "{head}");
        folder.run("measure named.obj p.ply").ok();
    }
}

#[test]
fn what_is_not_there_is_said() {
    let folder = textured();
    folder.write("octahedron.obj", OCTAHEDRON);
    let wrap = |rest: &str| folder.run(&format!("wrap {rest}"));
    wrap("octahedron.obj -o p.csv --attributes uv").failed(&["octahedron.obj", "has no uv", "leave it out"]);
    wrap("octahedron.obj -o p.csv --attributes property:heat").failed(&["has no property:heat"]);
    wrap("octahedron.obj -o p.csv --attributes nonsense").refused(&["must be all, property:NAME, or one of"]);
    wrap("octahedron.obj -o p.csv --attributes uv,uv").refused(&["uv is given twice"]);
    wrap("octahedron.obj -o p.csv --attributes uv,all").refused(&["all stands alone"]);
    wrap("octahedron.obj -o p.npy --attributes uv").refused(&["npy cannot hold uv"]);
    wrap("octahedron.obj -o p.obj --attributes face").refused(&["obj cannot hold face"]);
    wrap("octahedron.obj --attributes face").refused(&["--output"]);
    std::fs::remove_file(folder.path("t.png")).expect("a file");
    wrap("square.obj -o p.csv --attributes color").failed(&["\"t.png\" is needed too", "keep it beside"]);
    wrap("square.obj -n 5 -o p.csv --attributes material").ok();
    std::fs::remove_file(folder.path("m.mtl")).expect("a file");
    wrap("square.obj -o p.csv --attributes color").failed(&["\"m.mtl\" is needed too"]);
}

#[test]
fn compressed_meshes_and_wrong_names() {
    let folder = Folder::with_octahedron();
    let zip = |bytes: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(bytes).expect("memory takes every byte");
        encoder.finish().expect("memory takes every byte")
    };
    folder.run("wrap octahedron.obj -n 20 -q -o plain.csv").ok();
    for extension in ["ply", "stl", "off", "obj"] {
        folder.run(&format!("shape cube -q -o cube.{extension}")).ok();
        let bytes = folder.read(&format!("cube.{extension}"));
        folder.write(&format!("cube.{extension}.gz"), zip(&bytes));
        folder.write("wrong.gltf", &bytes);
        let info = |name: &str| folder.run(&format!("info {name} --json -q")).ok().json();
        assert_eq!(info(&format!("cube.{extension}.gz")), info(&format!("cube.{extension}")));
        assert_eq!(info("wrong.gltf"), info(&format!("cube.{extension}")));
    }
    let zipped = zip(OCTAHEDRON.as_bytes());
    folder.write("o.gz", &zipped);
    folder.run("wrap o.gz -n 20 -q -o zipped.csv").ok();
    assert_eq!(folder.read("zipped.csv"), folder.read("plain.csv"));
    folder.write("cut.obj.gz", &zipped[..zipped.len() / 2]);
    folder.run("info cut.obj.gz").failed(&["cut.obj.gz", "gzip", "copy it again"]);
    folder.write("a.obj", b"PK\x03\x04....");
    folder.run("info a.obj.gz").failed(&["a.obj.gz"]);
    folder.write("model.fbx", b"Kaydara FBX Binary  \0");
    folder.run("info model.fbx").failed(&["this is FBX", "convert it to OBJ"]);
}

/// Runs only where the environment variable names a Python that has NumPy, Open3D, trimesh and pymeshlab.
#[test]
fn other_programs_read_the_same() {
    let Some(python) = std::env::var_os("LDWRAP_PEERS_PYTHON") else {
        eprintln!("skipped: LDWRAP_PEERS_PYTHON names no Python with numpy, open3d, trimesh and pymeshlab");
        return;
    };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/peers.py");
    let output =
        Command::new(python).args([script, env!("CARGO_BIN_EXE_ldwrap-cli")]).output().expect("Python runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
