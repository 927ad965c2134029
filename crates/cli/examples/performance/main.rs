//! What is measured about speed and memory, other samplers beside it: writes the table in PERFORMANCE.md.
//!
//! `cargo run --release -p ldwrap-cli --example performance -- MESHES_FOLDER --peers PYTHON`
//!
//! MESHES_FOLDER holds `horse.ply`; PYTHON has the package open3d, and point-cloud-utils if that is to be compared too:
//! `python3 -m venv V && V/bin/pip install open3d point-cloud-utils`, then `V/bin/python`. Without `--peers` only what
//! needs no peer is measured, and nothing is written. Take an idle machine.

mod equalized;
mod growth;
mod machine;
mod memory;
mod peers;
mod points;
mod program;
mod strips;
mod table;
mod timing;

use std::path::{Path, PathBuf};

use clap::Parser;
use ldwrap::pipeline::{Options, Request, Run, run};
use ldwrap::{CheckOptions, Silent, SurfaceMesh, io};

use peers::Peers;
use table::Row;

pub(crate) type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

#[derive(Debug, Parser)]
struct Arguments {
    /// The folder of horse.ply
    meshes: PathBuf,
    /// A Python with the peers
    #[arg(long, value_name = "PYTHON")]
    peers: Option<PathBuf>,
    /// How often each work is done
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..))]
    repeats: u8,
    /// Also 10 million triangles and points, and equalizing a million: 20 minutes, 8 GiB
    #[arg(long)]
    large: bool,
    /// Only these parts: points, strips, program, equalize, growth, memory
    #[arg(long, value_name = "PART")]
    only: Vec<String>,
    /// The folder of PERFORMANCE.md, which is written when all parts were measured
    #[arg(long, value_name = "FOLDER", default_value = "docs")]
    docs: PathBuf,
}

/// Measures some lines of the table.
type Part = fn(&mut Bench) -> Outcome<Vec<Row>>;

/// What the parts share.
pub(crate) struct Bench {
    /// The horse's file.
    pub(crate) file: PathBuf,
    pub(crate) mesh: SurfaceMesh,
    pub(crate) rounds: usize,
    pub(crate) large: bool,
    /// The interpreter, to start it anew.
    pub(crate) python: Option<PathBuf>,
    pub(crate) peers: Option<Peers>,
}

fn main() -> Outcome {
    // The same program measures its own memory in a process that has done nothing else.
    if let Some(order) = memory::order(std::env::args_os().skip(1)) {
        return memory::child(&order);
    }
    let arguments = Arguments::parse();
    let file = arguments.meshes.join("horse.ply");
    let mesh = read(&file)?;
    let peers = arguments.peers.as_deref().map(|python| Peers::start(python, &file)).transpose()?;
    let head = machine::head(peers.as_ref(), usize::from(arguments.repeats));
    eprintln!("{head}");
    let mut bench = Bench {
        file,
        mesh,
        rounds: usize::from(arguments.repeats),
        large: arguments.large,
        python: arguments.peers,
        peers,
    };
    let parts: [(&str, Part); 6] = [
        ("points", points::rows),
        ("strips", strips::rows),
        ("program", program::rows),
        ("equalize", equalized::rows),
        ("growth", growth::rows),
        ("memory", memory::rows),
    ];
    if let Some(unknown) = arguments.only.iter().find(|only| parts.iter().all(|(name, _)| name != only)) {
        return Err(format!("no part is named {unknown}").into());
    }
    let mut rows = Vec::new();
    for (name, part) in parts {
        if arguments.only.is_empty() || arguments.only.iter().any(|only| only == name) {
            for row in part(&mut bench)? {
                eprintln!("{}", row.line());
                rows.push(row);
            }
        }
    }
    if bench.peers.is_none() || !arguments.only.is_empty() {
        eprintln!("not everything was measured, so nothing is written");
        return Ok(());
    }
    let document = arguments.docs.join("PERFORMANCE.md");
    let text = std::fs::read_to_string(&document)?;
    std::fs::write(&document, table::replaced(&text, &table::table(&head, &rows))?)?;
    eprintln!("{} is written", document.display());
    Ok(())
}

/// Reads and checks a mesh.
pub(crate) fn read(file: &Path) -> Outcome<SurfaceMesh> {
    let bytes = std::fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let soup = io::read_mesh(&bytes, None, &|_| Err("no other file".into()))?;
    Ok(SurfaceMesh::from_soup(&soup, &CheckOptions::default())?.0)
}

/// All stages from segmenting on, for `count` points; with equalizing if the options say so.
pub(crate) fn all_stages(mesh: &SurfaceMesh, count: usize, options: Options) -> Outcome<Run> {
    Ok(run(mesh, &Options { request: Request::Count(count), ..options }, &Silent)?)
}
