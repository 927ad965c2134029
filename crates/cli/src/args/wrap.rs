//! The options of `wrap`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use glam::DVec3;
use ldwrap::io::points::{Attribute, PointFormat};

use super::{MeshArgs, RequestArgs, SegmentArgs, SequenceArgs, point_formats};

#[derive(Debug, Args)]
pub(crate) struct WrapArgs {
    #[command(flatten)]
    pub(crate) mesh: MeshArgs,
    #[command(flatten)]
    pub(crate) placing: PlacingArgs,
    #[command(flatten)]
    pub(crate) outputs: WrapOutputArgs,
}

/// Everything that decides where on a mesh the points lie, and their order.
#[derive(Debug, Args)]
pub(crate) struct PlacingArgs {
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
    /// Work on the surface inside this box alone: its smallest coordinates, then its largest, which may be -inf and inf.
    /// Faces are cut exactly at its sides
    #[arg(long = "box", value_name = "X,Y,Z,X,Y,Z", conflicts_with = "weights", allow_hyphen_values = true)]
    pub(crate) inside: Option<BoxArg>,
    /// Give each connected component at least M of the points; those with a larger share of the area give them
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with_all = ["density", "spacing", "irregularity", "per_component", "no_equalize", "for_views"])]
    pub(crate) at_least: Option<u32>,
    #[command(flatten)]
    pub(crate) weights: WeightsArgs,
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

/// A box along the axes: the smallest and the largest coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoxArg(pub(crate) DVec3, pub(crate) DVec3);

impl FromStr for BoxArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse::<f64>()).collect();
        match numbers.as_deref() {
            Ok(&[a, b, c, x, y, z]) if a <= x && b <= y && c <= z => {
                Ok(Self(DVec3::new(a, b, c), DVec3::new(x, y, z)))
            }
            Ok(&[_, _, _, _, _, _]) => Err("the three smallest coordinates come first".to_owned()),
            _ => Err("six numbers with commas between are needed, such as 0,0,0,1,inf,2".to_owned()),
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
    /// Write the points: .ply, .xyz, .csv, .npy, .npz, .json, .obj or .glb, or `-` for stdout with --format. With
    /// --no-equalize they are written while they are made, so that memory never holds them all; not so with --order
    /// progressive, as .npz, .obj or .glb, with cell-area, and beside --strips, --preview or --quality, which look at all
    #[arg(short, long, value_name = "POINTS")]
    pub(crate) output: Option<PathBuf>,
    /// The format of the points [default: by the name's extension]
    #[arg(long, value_name = "FORMAT", requires = "output", value_parser = point_formats())]
    pub(crate) format: Option<PointFormat>,
    #[command(flatten)]
    pub(crate) attributes: AttributesArgs,
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

/// What points carry.
#[derive(Debug, Args)]
#[command(next_help_heading = "Outputs")]
pub(crate) struct AttributesArgs {
    /// What the points carry besides their position: flat-normal, smooth-normal, uv, color, vertex-color, material,
    /// part, face, polygon, barycentric, strip, place, origin, cell-area, property:NAME of a PLY file; or all that
    /// mesh and format have [default: flat-normal, face, barycentric, strip, place, origin, where the format has room]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "output")]
    pub(crate) attributes: Vec<AttributeArg>,
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
