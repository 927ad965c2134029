//! The options of `batch`.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use ldwrap::io::points::PointFormat;

use super::wrap::AttributesArgs;
use super::{PlacingArgs, ReadingArgs, point_formats};

#[derive(Debug, Args)]
#[command(after_help = "A run that was stopped goes on where it was when the same command is given again. \
    Outputs appear complete or not at all; a mesh that cannot be used is told in the summary and stops no other. \
    Exit codes: 0 all done, 1 some failed, 2 wrong use.")]
pub(crate) struct BatchArgs {
    /// Mesh files, folders of them, and patterns such as 'scans/**/*.ply' (in quotes, so that the shell leaves them
    /// alone). In folders, and all folders in them, PLY, OBJ, STL, glTF, GLB and OFF files are taken, also with .gz
    #[arg(value_name = "IN", required_unless_present = "list")]
    pub(crate) inputs: Vec<PathBuf>,
    /// Take the files and folders in this text file too, one a line, or `-` for stdin
    #[arg(long, value_name = "FILE")]
    pub(crate) list: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) outputs: BatchOutputArgs,
    #[command(flatten)]
    pub(crate) running: RunningArgs,
    #[command(flatten)]
    pub(crate) reading: ReadingArgs,
    #[command(flatten)]
    pub(crate) placing: PlacingArgs,
    #[command(flatten)]
    pub(crate) attributes: AttributesArgs,
}

/// Where the results of `batch` go.
#[derive(Debug, Args)]
#[command(next_help_heading = "Outputs")]
pub(crate) struct BatchOutputArgs {
    /// The folder for the points, `journal.jsonl` and `summary.csv`; made if there is none
    #[arg(short, long, value_name = "OUT_DIR")]
    pub(crate) output: PathBuf,
    /// Name outputs by the path from this folder to the mesh [default: from the folder or the pattern's folder in
    /// which it is found; the name alone of a file that is given itself]
    #[arg(long, value_name = "DIR")]
    pub(crate) base: Option<PathBuf>,
    /// The format of the points
    #[arg(long, value_name = "FORMAT", default_value = "ply", value_parser = point_formats())]
    pub(crate) format: PointFormat,
    /// Keep the extensions of meshes in the names of outputs, a.obj.ply instead of a.ply
    #[arg(long)]
    pub(crate) full_names: bool,
    /// Measure eta too, the energy's floor over the energy; costs more than the points
    #[arg(long)]
    pub(crate) eta: bool,
}

/// How the work is shared out.
#[derive(Debug, Args)]
#[command(next_help_heading = "Jobs")]
pub(crate) struct RunningArgs {
    /// Work on this many meshes at a time [default: one for each thread]; the threads are shared among them
    #[arg(long, value_name = "J", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Take the I-th of K parts of the meshes alone; parts may run at the same time into one OUT_DIR
    #[arg(long, value_name = "I/K")]
    pub(crate) shard: Option<Shard>,
    /// Make outputs anew that were made with other options or by another version, instead of refusing to start
    #[arg(long)]
    pub(crate) redo: bool,
    /// Do no work: write `summary.csv` from what is done, of all parts
    #[arg(long, conflicts_with_all = ["redo", "jobs"])]
    pub(crate) summary_only: bool,
}

/// One of several parts of a list: every K-th mesh from the I-th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    index: u32,
    count: u32,
}

impl Shard {
    /// Whether it has the mesh at this place of the list, counted from 0.
    pub(crate) fn has(self, place: usize) -> bool {
        place as u64 % u64::from(self.count) == u64::from(self.index - 1)
    }
}

/// For names of files: `2-of-8`.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-of-{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.parse::<u32>().ok();
        match text.split_once('/').map(|(index, count)| (number(index), number(count))) {
            Some((Some(index), Some(count))) if (1..=count).contains(&index) => Ok(Self { index, count }),
            Some((Some(_), Some(_))) => Err("must be 1/K to K/K".to_owned()),
            _ => Err("must be two whole numbers, such as 3/8 for the third of eight parts".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn every_place_is_in_one_shard() {
        for count in [1, 2, 3, 7] {
            let shards: Vec<Shard> = (1..=count).map(|i| format!("{i}/{count}").parse().unwrap()).collect();
            for place in 0..20 {
                assert_eq!(shards.iter().filter(|shard| shard.has(place)).count(), 1);
            }
        }
        assert_eq!("3/8".parse::<Shard>().unwrap().to_string(), "3-of-8");
    }

    #[test]
    fn shards_that_are_none() {
        for text in
            ["0/3", "4/3", "0/0", "1/0", "3", "/", "a/b", "-1/3", "1/3/4", "1.5/3", "", "1/99999999999"]
        {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
