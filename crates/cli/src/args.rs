//! The command line as it is typed. What the values mean together is checked in `job`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use ldwrap::io::points::{Attribute, PointFormat};
use ldwrap::segment::{GrowthOrder, SegmentOptions};
use ldwrap::shapes::Shape;
use serde::Serialize;

use crate::methods::Method;

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
    /// The format of the mesh [default: told by its content, then by its name]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) mesh_format: Option<MeshFormatArg>,
    /// Leave components that are wound inward as they are, instead of turning them outward
    #[arg(long)]
    pub(crate) keep_winding: bool,
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
pub(crate) struct WrapArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    #[command(flatten)]
    pub(crate) request: RequestArgs,
    #[command(flatten)]
    pub(crate) sequence: SequenceArgs,
    #[command(flatten)]
    pub(crate) segment: SegmentArgs,
    /// Leave the points where wrapping puts them, instead of evening out the area each stands for
    #[arg(long)]
    pub(crate) no_equalize: bool,
    #[command(flatten)]
    pub(crate) views: ForViewsArgs,
    /// Which of the wrapped points are taken
    #[arg(long, value_enum, value_name = "HOW", default_value = "regions")]
    pub(crate) select: SelectArg,
    /// In which order the points are written
    #[arg(long, value_enum, value_name = "ORDER", default_value = "sequence")]
    pub(crate) order: OrderArg,
    /// Work on the faces of this material or part alone, as material:NAME or part:NAME; may be given several times
    #[arg(long, value_name = "WHAT", conflicts_with = "weights")]
    pub(crate) only: Vec<OnlyArg>,
    #[command(flatten)]
    pub(crate) weights: WeightsArgs,
    #[command(flatten)]
    pub(crate) outputs: WrapOutputArgs,
}

/// Three finite numbers, not all 0.
fn direction(text: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse::<f64>()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() && [x, y, z] != [0.0; 3] => {
            Ok(DVec3::new(x, y, z))
        }
        _ => {
            Err("three finite numbers with commas between, not all 0, are needed, such as 0,-1,0.5"
                .to_owned())
        }
    }
}

/// Points that tell the visible share.
#[derive(Debug, Args)]
#[command(next_help_heading = "Views")]
pub(crate) struct ForViewsArgs {
    /// Let each point take the place in its cell that makes the visible share of the points tell that of the surface
    /// best, over many views; takes some seconds and costs a little evenness
    #[arg(long, conflicts_with = "no_equalize")]
    pub(crate) for_views: bool,
    /// The views to serve come from around this direction, from the mesh to the camera [default: from everywhere]
    #[arg(long, value_name = "X,Y,Z", requires = "for_views", value_parser = direction, allow_hyphen_values = true)]
    pub(crate) view_from: Option<DVec3>,
    /// They come from within this many degrees of it
    #[arg(long, value_name = "DEGREES", requires = "view_from", default_value = "30")]
    pub(crate) view_angle: f64,
    /// Cameras stand this far from the middle of the mesh, in its units [default: infinitely far]
    #[arg(long, value_name = "LENGTH", requires = "view_from")]
    pub(crate) view_distance: Option<f64>,
    /// How many views are served [default: by the number of points]
    #[arg(long, value_name = "VIEWS", requires = "for_views", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) views: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SelectArg {
    /// Of twice as many points the most central one in each of as many regions of equal area as points are wanted
    Regions,
    /// The paper's: a small surplus is left out along the sequence
    Sequence,
    /// The first points of the sequence, so that more points contain fewer; for halton, sobol and r2; neither corrected
    /// nor equalized
    Extensible,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum OrderArg {
    /// That of the sequence
    Sequence,
    /// The first k are well spread for every k
    Progressive,
}

/// Where points are to lie more densely.
#[derive(Debug, Args)]
#[command(next_help_heading = "Weights")]
pub(crate) struct WeightsArgs {
    /// Make points in proportion to these weights: a text file with one number a line (or CSV, whose last column
    /// counts) for each vertex or for each face of the mesh file
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
    /// What the weights belong to [default: told by their number]
    #[arg(long, value_enum, value_name = "WHAT", requires = "weights")]
    pub(crate) weights_of: Option<WeightsOf>,
    /// Make points in proportion to what the mesh file has at its corners: property:NAME of a PLY file, or red, green,
    /// blue, luminance or alpha of the base colour (in linear light, 0 to 1); linear on each triangle
    #[arg(long, value_name = "NAME", conflicts_with = "weights")]
    pub(crate) weights_by: Option<WeightsBy>,
}

/// What the mesh has that weights are taken from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum WeightsBy {
    Red,
    Green,
    Blue,
    Luminance,
    Alpha,
    Property(String),
}

impl FromStr for WeightsBy {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "red" => Self::Red,
            "green" => Self::Green,
            "blue" => Self::Blue,
            "luminance" => Self::Luminance,
            "alpha" => Self::Alpha,
            text => match text.strip_prefix("property:") {
                Some(name) if !name.is_empty() => Self::Property(name.to_owned()),
                _ => return Err("must be red, green, blue, luminance, alpha or property:NAME".to_owned()),
            },
        })
    }
}

/// A material or a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum OnlyArg {
    Material(String),
    Part(String),
}

impl FromStr for OnlyArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            Some(("material", name)) if !name.is_empty() => Ok(Self::Material(name.to_owned())),
            Some(("part", name)) if !name.is_empty() => Ok(Self::Part(name.to_owned())),
            _ => Err("must be material:NAME or part:NAME".to_owned()),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WeightsOf {
    /// The vertices of the mesh file; linear between them
    Vertices,
    /// The faces of the mesh file; constant on each
    Faces,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Outputs")]
pub(crate) struct WrapOutputArgs {
    /// Write the points: .ply, .xyz, .csv, .npy, .npz, .json, .obj or .glb, or `-` for stdout with --format
    #[arg(short, long, value_name = "POINTS")]
    pub(crate) output: Option<PathBuf>,
    /// The format of the points [default: by the name's extension]
    #[arg(long, value_name = "FORMAT", requires = "output", value_parser = point_formats())]
    pub(crate) format: Option<PointFormat>,
    /// What the points carry besides their position: flat-normal, smooth-normal, uv, color, vertex-color, material,
    /// part, face, polygon, barycentric, strip, place, origin, cell-area, property:NAME of a PLY file; or all that
    /// mesh and format have [default: flat-normal, face, barycentric, strip, place, origin, where the format has room]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "output")]
    pub(crate) attributes: Vec<AttributeArg>,
    /// Draw the strips in the plane with their points, as SVG
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) strips: Option<PathBuf>,
    /// Write what was done as JSON, or `-` for stdout
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
    /// Draw the mesh in the colours of its strips with its visible points, as PNG
    #[arg(long, value_name = "FILE.png")]
    pub(crate) preview: Option<PathBuf>,
    /// Measure the points too, as `measure` does, and add that to the report
    #[arg(long, requires = "report")]
    pub(crate) quality: bool,
}

/// An attribute, or all of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum AttributeArg {
    All,
    One(Attribute),
}

impl FromStr for AttributeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Self::All),
            text => text.parse().map(Self::One).map_err(|_| {
                let known: Vec<String> = Attribute::FIXED.iter().map(ToString::to_string).collect();
                format!("must be all, property:NAME, or one of {}", known.join(", "))
            }),
        }
    }
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
pub(crate) struct MeasureArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    /// The points: a PLY, XYZ, CSV, NPY, NPZ, JSON, OBJ or GLB file from any tool, or `-` for stdin
    #[arg(value_name = "POINTS")]
    pub(crate) points: PathBuf,
    /// The format of the points [default: told by their content, then by the name]
    #[arg(long, value_name = "FORMAT", value_parser = point_formats())]
    pub(crate) points_format: Option<PointFormat>,
    /// Print JSON; the same bits on every run, but for the wall times in `seconds`
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    /// How many points, one table row a method for each
    #[arg(short = 'n', long = "count", value_name = "N,...", value_delimiter = ',', default_value = "56,335,1000",
        value_parser = clap::value_parser!(u32).range(1..=MOST_COMPARED_POINTS))]
    pub(crate) counts: Vec<u32>,
    /// The methods [default: all that work on the mesh but for-views, which takes seconds]
    #[arg(long, value_enum, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) methods: Option<Vec<Method>>,
    /// How many seeds, from --seed on; more than one give the spread
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) seeds: u32,
    /// Compare with points from a file of another tool; may be given several times
    #[arg(long, value_name = "NAME=FILE")]
    pub(crate) points: Vec<PointsOf>,
    #[command(flatten)]
    pub(crate) sequence: SequenceArgs,
    #[command(flatten)]
    pub(crate) segment: SegmentArgs,
    /// Print JSON; the same bits on every run, but for the wall times in `seconds`
    #[arg(long)]
    pub(crate) json: bool,
    /// Draw the errors against the number of points, as SVG
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
}

/// Every set is kept until all are measured: ten million points of seven methods take some 2 GB.
const MOST_COMPARED_POINTS: i64 = 10_000_000;

/// A point file and what it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PointsOf {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
}

impl FromStr for PointsOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, path)) if !name.is_empty() && !path.is_empty() => {
                Ok(Self { name: name.to_owned(), path: path.into() })
            }
            _ => Err("must be NAME=FILE".to_owned()),
        }
    }
}

/// A point set on the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PlanarSet {
    /// A square lattice; only of square numbers
    Lattice,
    /// Independent uniform points
    Random,
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

impl PlanarSet {
    /// All of them.
    pub(crate) const ALL: [Self; 7] =
        [Self::Lattice, Self::Random, Self::Hammersley, Self::Halton, Self::Sobol, Self::R2, Self::Fibonacci];

    /// Its name as it is typed.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The low-discrepancy set of this name; none is the lattice or random points.
    pub(crate) fn sequence(self) -> Option<SequenceArg> {
        match self {
            Self::Lattice | Self::Random => None,
            Self::Hammersley => Some(SequenceArg::Hammersley),
            Self::Halton => Some(SequenceArg::Halton),
            Self::Sobol => Some(SequenceArg::Sobol),
            Self::R2 => Some(SequenceArg::R2),
            Self::Fibonacci => Some(SequenceArg::Fibonacci),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct PlaneArgs {
    /// How many points, one table row a set for each
    #[arg(short = 'n', long = "count", value_name = "N,...", value_delimiter = ',', default_value = "256",
        value_parser = clap::value_parser!(u32).range(1..=MOST_PLANAR_POINTS))]
    pub(crate) counts: Vec<u32>,
    /// The sets [default: all]
    #[arg(long = "sequence", value_enum, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) sequences: Option<Vec<PlanarSet>>,
    /// The bases of the radical inverses: one for hammersley [default: 2], two for halton [default: 2,3], which
    /// must have no common factor
    #[arg(long, value_delimiter = ',', value_name = "A[,B]", requires = "sequences",
        value_parser = clap::value_parser!(u32).range(2..))]
    pub(crate) bases: Option<Vec<u32>>,
    /// Shift the sets (Cranley-Patterson rotation); 0 leaves them as they are. The lattice is never shifted
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// How many seeds, from --seed on; more than one give the spread
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) seeds: u32,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// The L2 discrepancy takes the square of the number of points: here a minute or two.
const MOST_PLANAR_POINTS: i64 = 200_000;

#[derive(Debug, Args)]
pub(crate) struct BoundArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    /// How many points, one table row for each
    #[arg(short = 'n', long = "count", value_name = "N,...", value_delimiter = ',', default_value = "56,335,1000",
        value_parser = clap::value_parser!(u32).range(1..=MOST_COMPARED_POINTS))]
    pub(crate) counts: Vec<u32>,
    #[command(flatten)]
    pub(crate) sequence: SequenceArgs,
    #[command(flatten)]
    pub(crate) segment: SegmentArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
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
