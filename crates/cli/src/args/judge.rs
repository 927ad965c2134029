//! The options of the commands that measure and compare.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use ldwrap::io::points::PointFormat;
use serde::Serialize;

use super::{MeshArgs, SegmentArgs, SequenceArg, SequenceArgs, point_formats};
use crate::methods::Method;

/// Every set is kept until all are measured: ten million points of seven methods take some 2 GB.
const MOST_COMPARED_POINTS: i64 = 10_000_000;

/// What the rows of a table are.
#[derive(Debug, Args)]
pub(crate) struct TableArgs {
    /// How many points, a table row for each
    #[arg(short = 'n', long = "count", value_name = "N,...", value_delimiter = ',', default_value = "56,335,1000",
        value_parser = clap::value_parser!(u32).range(1..=MOST_COMPARED_POINTS))]
    pub(crate) counts: Vec<u32>,
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
    #[command(flatten)]
    pub(crate) table: TableArgs,
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
    #[command(flatten)]
    pub(crate) table: TableArgs,
    #[command(flatten)]
    pub(crate) sequence: SequenceArgs,
    #[command(flatten)]
    pub(crate) segment: SegmentArgs,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}
