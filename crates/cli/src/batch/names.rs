//! The names of outputs: a mesh's own path below a folder, with the extension of the points.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::Context;
use ldwrap::io::points::PointFormat;

use crate::args::BatchOutputArgs;
use crate::batch::Task;
use crate::batch::record::{Kind, Trouble};
use crate::exit::{Failure, Outcome};

/// What files of meshes end in; each also with `.gz` behind it.
const MESHES: [&str; 6] = ["ply", "obj", "stl", "gltf", "glb", "off"];

/// How the name of an output comes from that of its mesh.
pub(crate) struct Naming {
    base: Option<PathBuf>,
    keep_extension: bool,
    extension: &'static str,
}

impl Naming {
    /// As the arguments say.
    pub(crate) fn new(args: &BatchOutputArgs) -> Outcome<Self> {
        let base = args.base.as_deref().map(|base| {
            std::path::absolute(base).with_context(|| format!("--base {}: cannot be told", base.display()))
        });
        let extension = match args.format {
            PointFormat::PlyAscii => PointFormat::Ply.name(),
            format => format.name(),
        };
        Ok(Self { base: base.transpose()?, keep_extension: args.full_names, extension })
    }

    /// The output of the mesh at `path`, which was found below `start`.
    pub(crate) fn output(&self, path: &Path, start: &Path) -> Outcome<Result<String, Trouble>> {
        let below = match &self.base {
            None => path.strip_prefix(start).unwrap_or(path).to_path_buf(),
            Some(base) => {
                let full = std::path::absolute(path).with_context(|| path.display().to_string())?;
                let below = full.strip_prefix(base).map(Path::to_path_buf);
                below.map_err(|_| {
                    Failure::wrong_use(format!("{}: lies outside --base {}", path.display(), base.display()))
                })?
            }
        };
        let mut parts = Vec::new();
        for part in below.components() {
            match part {
                Component::Normal(part) => parts.push(part),
                Component::CurDir => {}
                Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                    return Err(Failure::wrong_use(format!(
                        "{}: cannot be mirrored below --output: add --base DIR, a folder that holds all meshes",
                        path.display()
                    )));
                }
            }
        }
        let text: Option<Vec<&str>> = parts.iter().map(|part| part.to_str()).collect();
        Ok(match text {
            Some(parts) => {
                let name = parts.join("/");
                let kept = if self.keep_extension { &*name } else { without_extension(&name) };
                Ok(format!("{kept}.{}", self.extension))
            }
            None => {
                let message = "its name is not UTF-8, so that no summary can hold it: rename it".to_owned();
                Err(Trouble { kind: Kind::Name, message })
            }
        })
    }
}

/// The extension that makes a file a mesh, if it has one.
pub(crate) fn mesh_extension(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?;
    let extension = if extension.eq_ignore_ascii_case("gz") {
        Path::new(path.file_stem()?).extension()?.to_str()?
    } else {
        extension
    };
    MESHES.into_iter().find(|known| extension.eq_ignore_ascii_case(known))
}

/// `a.ply` and `a.ply.gz` are `a`; a dot before something else is part of the name.
fn without_extension(name: &str) -> &str {
    let cut = |name: &'_ str| {
        let (stem, extension) = name.rsplit_once('.')?;
        Some((stem.len(), extension.to_ascii_lowercase()))
    };
    if mesh_extension(Path::new(name)).is_none() {
        return name;
    }
    let unpacked = match cut(name) {
        Some((length, extension)) if extension == "gz" => &name[..length],
        _ => name,
    };
    cut(unpacked).map_or(unpacked, |(length, _)| &unpacked[..length])
}

/// Makes sure that every output has a name of its own, which is neither that of a summary nor of a mesh.
pub(crate) fn check(tasks: &[Task], out: &Path) -> Outcome {
    let mut inputs: HashMap<&str, &Path> = HashMap::with_capacity(tasks.len());
    for task in tasks {
        let Ok(output) = &task.output else { continue };
        if let Some(other) = inputs.insert(output, &task.input) {
            return Err(Failure::wrong_use(format!(
                "{} and {} would both go to {}: add --full-names to keep their extensions, or --base DIR to keep \
                 their folders",
                other.display(),
                task.input.display(),
                out.join(output).display()
            )));
        }
        if is_summary(output) {
            return Err(Failure::wrong_use(format!(
                "{} would go to {}, the name of the summary: add --full-names",
                task.input.display(),
                out.join(output).display()
            )));
        }
    }
    for task in tasks {
        let Ok(output) = &task.output else { continue };
        let above = output.match_indices('/').map(|(end, _)| &output[..end]);
        if let Some(other) = above.into_iter().find_map(|folder| inputs.get(folder)) {
            return Err(Failure::wrong_use(format!(
                "the output of {} would be a folder for that of {}: rename one",
                other.display(),
                task.input.display()
            )));
        }
    }
    check_inputs_stay(tasks, out)
}

fn is_summary(output: &str) -> bool {
    !output.contains('/') && output.starts_with("summary.") && output.ends_with(".csv")
}

/// Refuses an output that is there already and is one of the meshes.
fn check_inputs_stay(tasks: &[Task], out: &Path) -> Outcome {
    if !out.exists() {
        return Ok(());
    }
    let mut folders = Folders::default();
    let meshes: HashSet<PathBuf> = tasks.iter().filter_map(|task| folders.full(&task.input)).collect();
    for task in tasks {
        let Ok(output) = &task.output else { continue };
        let output = out.join(output);
        if folders.full(&output).is_some_and(|full| meshes.contains(&full)) {
            return Err(Failure::wrong_use(format!(
                "the points of {} would overwrite the mesh {}: choose another --output",
                task.input.display(),
                output.display()
            )));
        }
    }
    Ok(())
}

/// Full paths of files; those of their folders are asked for once.
#[derive(Default)]
struct Folders(HashMap<PathBuf, Option<PathBuf>>);

impl Folders {
    fn full(&mut self, file: &Path) -> Option<PathBuf> {
        let folder = file.parent()?;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        if !self.0.contains_key(folder) {
            self.0.insert(folder.to_path_buf(), fs::canonicalize(folder).ok());
        }
        Some(self.0.get(folder)?.as_ref()?.join(file.file_name()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn naming(keep_extension: bool) -> Naming {
        Naming { base: None, keep_extension, extension: "csv" }
    }

    fn name(path: &str, start: &str) -> String {
        naming(false).output(Path::new(path), Path::new(start)).unwrap().unwrap()
    }

    #[test]
    fn names_of_outputs() {
        assert_eq!(name("m/a/b.ply", "m"), "a/b.csv");
        assert_eq!(name("./m/b.PLY.gz", "./m"), "b.csv");
        assert_eq!(name("b.v2.obj", ""), "b.v2.csv");
        assert_eq!(name("scan.v2", ""), "scan.v2.csv");
        assert_eq!(name("notes.tar.gz", ""), "notes.tar.gz.csv");
        assert_eq!(name("a.ply/b.ply", ""), "a.ply/b.csv");
        assert_eq!(
            naming(true).output(Path::new("a.ply.gz"), Path::new("")).unwrap().unwrap(),
            "a.ply.gz.csv"
        );
        assert!(naming(false).output(Path::new("../a.ply"), Path::new("")).is_err());
    }

    #[test]
    fn a_base_keeps_folders() {
        let naming = Naming { base: Some(PathBuf::from("/data")), ..naming(false) };
        assert_eq!(
            naming.output(Path::new("/data/x/a.ply"), Path::new("/data/x")).unwrap().unwrap(),
            "x/a.csv"
        );
        assert!(naming.output(Path::new("/else/a.ply"), Path::new("")).is_err());
        assert!(naming.output(Path::new("/data/../a.ply"), Path::new("")).is_err());
    }

    #[test]
    fn what_is_a_mesh_by_its_name() {
        for name in ["a.ply", "a.OBJ", "b/a.glb.gz", "a.x.off"] {
            assert!(mesh_extension(Path::new(name)).is_some(), "{name}");
        }
        for name in ["a", "a.mtl", "a.gz", "a.ply.zip", "ply", ".ply", "a.tar.gz"] {
            assert!(mesh_extension(Path::new(name)).is_none(), "{name}");
        }
    }

    fn task(input: &str, output: &str) -> Task {
        Task { input: PathBuf::from(input), output: Ok(output.to_owned()) }
    }

    #[test]
    fn names_that_meet_are_refused_with_both() {
        let out = Path::new("/no such folder");
        let told = |tasks: &[Task]| match check(tasks, out) {
            Err(Failure::WrongUse(message)) => message,
            other => panic!("{other:?}"),
        };
        let message = told(&[task("a.ply", "a.csv"), task("b.ply", "b.csv"), task("a.obj", "a.csv")]);
        assert!(message.contains("a.ply") && message.contains("a.obj") && message.contains("--full-names"));
        let message = told(&[task("a.csv/b.ply", "a.csv/b.csv"), task("a.ply", "a.csv")]);
        assert!(message.contains("a.csv/b.ply") && message.contains("a.ply"));
        assert!(told(&[task("summary.ply", "summary.csv")]).contains("summary"));
        assert!(check(&[task("a.ply", "a.csv"), task("x/summary.ply", "x/summary.csv")], out).is_ok());
    }
}
