//! The command line as it is typed. What the values mean together is checked in `job`.

mod batch;
mod judge;
mod wrap;

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use ldwrap::io::points::PointFormat;
use ldwrap::segment::{GrowthOrder, SegmentOptions};
use ldwrap::shapes::Shape;

use crate::memory;

pub(crate) use batch::{BatchArgs, BatchOutputArgs, Shard};
pub(crate) use judge::{BoundArgs, CompareArgs, MeasureArgs, PlanarSet, PlaneArgs, PointsOf};
pub(crate) use wrap::{
    AttributeArg, BoxArg, ForViewsArgs, OnlyArg, OrderArg, PlacingArgs, SelectArg, WeightsArgs, WeightsBy,
    WeightsOf, WrapArgs, WrapOutputArgs,
};

/// Spreads low-discrepancy points over polygon meshes.
///
/// Every part of the surface, every view of it and every piece that is left visible behind an obstacle holds its
/// fair share of the points.
#[derive(Debug, Parser)]
#[command(name = "ldwrap-cli", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Exit codes: 0 done, 1 failed, 2 wrong use.")]
pub(crate) struct CommandLine {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Use this many threads [default: all cores]; the results are the same bits with any number
    #[arg(long, global = true, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Print nothing on stderr but errors
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Spread points over a mesh
    Wrap(Box<WrapArgs>),
    /// Spread points over many meshes: folders, patterns, lists
    Batch(Box<BatchArgs>),
    /// Draw how a mesh is segmented and unfolded, without points
    Strips(StripsArgs),
    /// Tell what a mesh is: counts, area, components, borders, what was repaired
    Info(InfoArgs),
    /// Make one of the built-in shapes
    Shape(ShapeArgs),
    /// Tell how good points are, whoever made them
    Measure(MeasureArgs),
    /// Compare methods by all measures
    Compare(CompareArgs),
    /// Tell how even point sets are in the unit square: star and L2 discrepancy
    Plane(PlaneArgs),
    /// Tell into how many parts figures fall when unfolded, and the paper's bounds (eq. 6 and 7)
    Bound(BoundArgs),
    /// Show a mesh, its strips, points and what a view sees in a window; needs the program ldwrap-web
    View(ViewArgs),
    /// Print the completions of a shell
    #[command(hide = true)]
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, of the program or of a command
    #[command(hide = true)]
    Man {
        /// The command
        command: Option<String>,
    },
}

/// Where the mesh comes from.
#[derive(Debug, Args)]
pub(crate) struct MeshArgs {
    /// The mesh: a PLY, OBJ, STL, glTF, GLB or OFF file, also compressed with gzip, or `-` for stdin
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
}

/// How a mesh is read.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct ReadingArgs {
    /// The format of the mesh [default: told by its content, then by its name]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) mesh_format: Option<MeshFormatArg>,
    /// Leave components that are wound inward as they are, instead of turning them outward
    #[arg(long)]
    pub(crate) keep_winding: bool,
    /// Refuse meshes, pictures and numbers of points that may need more memory than SIZE: bytes, or with K, M, G or T
    /// behind the number [default: three quarters of what the machine, the container or the shell allows]; never files
    /// above 16G or 268 million vertices
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub(crate) max_memory: Option<u64>,
}

impl ReadingArgs {
    /// The most memory that a run may plan with, in bytes.
    pub(crate) fn memory(&self) -> u64 {
        self.max_memory.unwrap_or_else(memory::planned)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeshFormatArg {
    Ply,
    Obj,
    Stl,
    /// As JSON or binary (GLB)
    Gltf,
    Off,
}

/// How many points; at most one of these.
#[derive(Debug, Args)]
#[group(required = false, multiple = false)]
pub(crate) struct RequestArgs {
    /// Make exactly N points [default: 1000]
    #[arg(short = 'n', long = "count", value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) count: Option<u32>,
    /// Make D points per squared unit of the mesh
    #[arg(long, value_name = "D", value_parser = positive)]
    pub(crate) density: Option<f64>,
    /// Make points with a mean distance S between neighbours, in units of the mesh
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) spacing: Option<f64>,
    /// Make as many points as bring the irregularity ratio R (eq. 8) down to this
    #[arg(long, value_name = "R", value_parser = positive)]
    pub(crate) irregularity: Option<f64>,
    /// Make exactly M points on each connected component of the mesh, large or small
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with_all = ["no_equalize", "for_views"])]
    pub(crate) per_component: Option<u32>,
}

/// How the surface is cut.
#[derive(Debug, Args)]
#[command(next_help_heading = "Segmentation")]
pub(crate) struct SegmentArgs {
    /// The largest angle between the normals of neighbours, in degrees, that counts as almost flat
    #[arg(long, value_name = "DEG", value_parser = angle,
        default_value_t = degrees(SegmentOptions::default().flatness_angle))]
    pub(crate) flatness_angle: f64,
    /// Strips with a smaller share of all triangles go on growing whatever the angle
    #[arg(long, value_name = "SHARE", value_parser = share, default_value_t = SegmentOptions::default().smallest_share)]
    pub(crate) smallest_share: f64,
    /// In which order a strip grows
    #[arg(long, value_enum, value_name = "ORDER", default_value_t = GrowthArg::from(SegmentOptions::default().order))]
    pub(crate) growth: GrowthArg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum GrowthArg {
    /// What opens the least border in the plane first; several ways are tried
    LeastOpen,
    /// The same, then parts of strips are hung elsewhere as long as that opens less; slower
    Rehung,
    /// The paper's: along the boundary, first in, first out
    BoundaryWalk,
    /// The smallest angle between the normals first
    FlattestFirst,
    /// The longest edge first
    LongestFirst,
}

impl From<GrowthOrder> for GrowthArg {
    fn from(order: GrowthOrder) -> Self {
        match order {
            GrowthOrder::LeastOpen => Self::LeastOpen,
            GrowthOrder::Rehung => Self::Rehung,
            GrowthOrder::BoundaryWalk => Self::BoundaryWalk,
            GrowthOrder::FlattestFirst => Self::FlattestFirst,
            GrowthOrder::LongestFirst => Self::LongestFirst,
        }
    }
}

impl From<GrowthArg> for GrowthOrder {
    fn from(arg: GrowthArg) -> Self {
        match arg {
            GrowthArg::LeastOpen => Self::LeastOpen,
            GrowthArg::Rehung => Self::Rehung,
            GrowthArg::BoundaryWalk => Self::BoundaryWalk,
            GrowthArg::FlattestFirst => Self::FlattestFirst,
            GrowthArg::LongestFirst => Self::LongestFirst,
        }
    }
}

/// Degrees as a person would write them: 60, not 59.99999999999999.
pub(crate) fn degrees(radians: f64) -> f64 {
    const DIGITS: f64 = 1e9;
    (radians.to_degrees() * DIGITS).round() / DIGITS
}

/// The point set on the planar domain.
#[derive(Debug, Args)]
#[command(next_help_heading = "Points in the plane")]
pub(crate) struct SequenceArgs {
    /// The low-discrepancy set that is wrapped onto the surface
    #[arg(long, value_enum, value_name = "NAME", default_value = "hammersley")]
    pub(crate) sequence: SequenceArg,
    /// The bases of the radical inverses: one for hammersley [default: 2], two for halton [default: 2,3], which
    /// must have no common factor
    #[arg(long, value_delimiter = ',', value_name = "A[,B]", value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) bases: Option<Vec<u32>>,
    /// Shift the set (Cranley-Patterson rotation), to repeat or replicate a run; 0 leaves it as it is
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Interstices and overlaps thinner than this many mean distances are corrected, 0 to 1
    #[arg(long, value_name = "T", default_value_t = 0.1, value_parser = share)]
    pub(crate) tolerance: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SequenceArg {
    /// (i / n, radical inverse of i)
    Hammersley,
    /// Radical inverses of i in two bases
    Halton,
    /// Sobol' with Owen's scrambling, which the seed chooses
    Sobol,
    /// Multiples of the powers of the plastic number
    R2,
    /// (i / n, i / golden ratio)
    Fibonacci,
}

#[derive(Debug, Args)]
pub(crate) struct StripsArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    #[command(flatten)]
    pub(crate) segment: SegmentArgs,
    /// The SVG picture, or `-` for stdout
    #[arg(short, long, value_name = "FILE.svg")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ShapeArgs {
    /// The shape
    #[arg(value_name = "NAME", value_parser = shapes())]
    pub(crate) shape: Shape,
    /// Make about this many triangles [default: the paper's, or what shows well]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Shape::MOST_FACES)))]
    pub(crate) faces: Option<u32>,
    /// The mesh to write: .ply, .obj, .stl or .off, or `-` for stdout with --format
    #[arg(short, long, value_name = "MESH")]
    pub(crate) output: PathBuf,
    /// The format of the mesh [default: by the name's extension]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) format: Option<ShapeFormat>,
}

/// A format that meshes are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeFormat {
    Ply,
    Obj,
    Stl,
    Off,
}

impl ShapeFormat {
    /// The extension of its files.
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Obj => "obj",
            Self::Stl => "stl",
            Self::Off => "off",
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ViewArgs {
    /// The mesh: a PLY, OBJ, STL, glTF, GLB or OFF file
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,
}

fn point_formats() -> impl TypedValueParser<Value = PointFormat> {
    PossibleValuesParser::new(PointFormat::ALL.map(PointFormat::name))
        .try_map(|name| PointFormat::from_name(&name).ok_or("no such format"))
}

fn shapes() -> impl TypedValueParser<Value = Shape> {
    PossibleValuesParser::new(Shape::ALL.map(Shape::name)).try_map(|name| name.parse::<Shape>())
}

/// A number of bytes; K, M, G and T stand for powers of 1024.
fn size(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let (number, shift) = match text.char_indices().last() {
        Some((end, 'k' | 'K')) => (&text[..end], 10),
        Some((end, 'm' | 'M')) => (&text[..end], 20),
        Some((end, 'g' | 'G')) => (&text[..end], 30),
        Some((end, 't' | 'T')) => (&text[..end], 40),
        _ => (text, 0),
    };
    let number: u64 =
        number.parse().map_err(|_| "must be a whole number of bytes, as 500M or 8G".to_owned())?;
    number
        .checked_mul(1 << shift)
        .filter(|&bytes| bytes > 0)
        .ok_or_else(|| "must be above 0 and below 16 million T".to_owned())
}

/// A number above 0.
fn positive(text: &str) -> Result<f64, String> {
    finite(text, |x| x > 0.0, "above 0")
}

fn share(text: &str) -> Result<f64, String> {
    finite(text, |x| (0.0..=1.0).contains(&x), "from 0 to 1")
}

fn angle(text: &str) -> Result<f64, String> {
    finite(text, |x| (0.0..=180.0).contains(&x), "from 0 to 180")
}

fn finite(text: &str, allowed: impl Fn(f64) -> bool, range: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() && allowed(x) => Ok(x),
        Ok(_) => Err(format!("must be a finite number {range}")),
        Err(_) => Err(format!("not a number; must be a finite number {range}")),
    }
}
