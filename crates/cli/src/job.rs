//! What is to be done: the command line, checked.

use std::ops::RangeInclusive;
use std::path::Path;

use ldwrap::equalize::{Cameras, EqualizeOptions, ForViews};
use ldwrap::io::Detail;
use ldwrap::io::points::{Attribute, PointFormat};
use ldwrap::pipeline::{Options, Request, SampleOrder, Selection};
use ldwrap::segment::SegmentOptions;
use ldwrap::sequence::Sequence;

use crate::args::{
    AttributeArg, ForViewsArgs, OrderArg, PlacingArgs, ReadingArgs, RequestArgs, SegmentArgs, SelectArg,
    SequenceArg, SequenceArgs, WrapOutputArgs,
};
use crate::exit::{Failure, Outcome};
use crate::input::Input;
use crate::output::{Destination, Targets};
use crate::points;
use crate::weights;

/// The points of a `wrap` run: where they go, in which format.
#[derive(Clone, Debug)]
pub(crate) struct PointOutput {
    pub(crate) destination: Destination,
    pub(crate) format: PointFormat,
    pub(crate) carried: Carried,
}

/// What points carry besides their position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Carried {
    /// What every format carries when nothing was asked for.
    Usual,
    /// These attributes.
    Named(Vec<Attribute>),
    /// All that mesh and format have.
    All,
}

impl Carried {
    /// How much must be read of the mesh for it.
    fn detail(&self) -> Detail {
        match self {
            Self::Usual => Detail::Shape,
            Self::Named(names) if names.contains(&Attribute::Color) => Detail::Textures,
            Self::Named(_) => Detail::Attributes,
            Self::All => Detail::Textures,
        }
    }
}

/// Where the results of `wrap` go.
#[derive(Clone, Debug, Default)]
pub(crate) struct WrapOutputs {
    pub(crate) points: Option<PointOutput>,
    pub(crate) strips: Option<Destination>,
    pub(crate) report: Option<Destination>,
    pub(crate) preview: Option<Destination>,
    /// Whether the report says how good the points are.
    pub(crate) quality: bool,
}

impl WrapOutputs {
    /// Checks the outputs against one another and against the file that is read.
    pub(crate) fn new(args: &WrapOutputArgs, input: &Path) -> Outcome<Self> {
        let mut targets = Targets::default();
        let points = args.output.as_deref().map(|path| point_output(path, args, &mut targets));
        let outputs = Self {
            points: points.transpose()?,
            strips: args.strips.as_deref().map(|path| targets.add("--strips", path)),
            report: args.report.as_deref().map(|path| targets.add("--report", path)),
            preview: args.preview.as_deref().map(|path| targets.add("--preview", path)),
            quality: args.quality,
        };
        targets.check(Some(input))?;
        Ok(outputs)
    }
}

/// How many of the points a run holds at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Held {
    /// A block: they are written as they are made.
    Block,
    /// All of them.
    All,
}

impl WrapOutputs {
    /// What the outputs need of the points of a mesh.
    pub(crate) fn held(&self, input: &Input) -> Held {
        let is_whole = |points: &PointOutput| !points::in_blocks(input, points.format, &points.carried);
        let looked_at = self.strips.is_some() || self.preview.is_some() || self.quality;
        if looked_at || self.points.as_ref().is_some_and(is_whole) { Held::All } else { Held::Block }
    }
}

fn point_output(path: &Path, args: &WrapOutputArgs, targets: &mut Targets) -> Outcome<PointOutput> {
    let destination = targets.add("--output", path);
    let format = match (args.format, &destination) {
        (Some(format), _) => format,
        (None, Destination::Stdout) => {
            return Err(Failure::wrong_use(
                "points on stdout need a format: add --format ply, ply-ascii, xyz, csv, npy, npz, json, obj or glb",
            ));
        }
        (None, Destination::File(path)) => point_format(path)?,
    };
    Ok(PointOutput { destination, format, carried: carried(&args.attributes.attributes, format)? })
}

/// What the arguments ask points in this format to carry.
pub(crate) fn carried(arguments: &[AttributeArg], format: PointFormat) -> Outcome<Carried> {
    refuse_repeated("--attributes", arguments, |argument| match argument {
        AttributeArg::All => "all".to_owned(),
        AttributeArg::One(attribute) => attribute.to_string(),
    })?;
    if arguments.is_empty() {
        return Ok(Carried::Usual);
    }
    if let [AttributeArg::All] = arguments {
        return Ok(Carried::All);
    }
    let mut attributes = Vec::new();
    for argument in arguments {
        let AttributeArg::One(attribute) = argument else {
            return Err(Failure::wrong_use("--attributes: all stands alone: leave out the others"));
        };
        if !attribute.fits(format) {
            return Err(Failure::wrong_use(format!(
                "--attributes: {format} cannot hold {attribute}: write .ply, .csv, .npz, .json or .glb"
            )));
        }
        attributes.push(attribute.clone());
    }
    Ok(Carried::Named(attributes))
}

/// The format that a file's name stands for.
fn point_format(path: &Path) -> Outcome<PointFormat> {
    let extension = path.extension().map(|extension| extension.to_string_lossy());
    extension.as_deref().and_then(PointFormat::from_name).ok_or_else(|| {
        let what = match &extension {
            Some(extension) => format!("no point format has the extension .{extension}"),
            None => "its name has no extension to tell the format by".to_owned(),
        };
        Failure::wrong_use(format!(
            "{}: {what}: known are .ply, .xyz, .csv, .npy, .npz, .json, .obj and .glb; or choose one with --format",
            path.display()
        ))
    })
}

/// Everything that decides the points.
pub(crate) fn options(args: &PlacingArgs) -> Outcome<Options> {
    let selection = match args.select {
        SelectArg::Regions => Selection::Regions,
        SelectArg::Sequence => Selection::Sequence,
        SelectArg::Extensible => Selection::Extensible,
    };
    if args.views.for_views && selection == Selection::Extensible {
        return Err(Failure::wrong_use("--for-views moves points, so extensible points cannot be for views"));
    }
    if quota(args).is_some() && selection == Selection::Extensible {
        return Err(Failure::wrong_use(
            "--per-component and --at-least move points, so extensible points cannot have them",
        ));
    }
    let equalize = !args.no_equalize && selection != Selection::Extensible;
    let options = Options {
        request: request(&args.request),
        selection,
        equalize: equalize
            .then(|| EqualizeOptions { for_views: for_views(&args.views), ..EqualizeOptions::default() }),
        order: match args.order {
            OrderArg::Sequence => SampleOrder::Sequence,
            OrderArg::Progressive => SampleOrder::Progressive,
        },
        ..wrap_options(&args.segment, &args.sequence)?
    };
    options.validate().map_err(|error| Failure::wrong_use(error.to_string()))?;
    Ok(options)
}

/// How points are shared out among the connected components, if not by mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quota {
    /// So many for each.
    Each(usize),
    /// At least so many for each.
    AtLeast(usize),
}

/// The quota that is asked for.
pub(crate) fn quota(args: &PlacingArgs) -> Option<Quota> {
    let each = args.request.per_component.map(|count| Quota::Each(count as usize));
    each.or(args.at_least.map(|count| Quota::AtLeast(count as usize)))
}

/// How much must be read of a mesh file for the points and what they carry.
pub(crate) fn detail(args: &PlacingArgs, carried: &Carried) -> Detail {
    let selecting = if args.only.is_empty() { Detail::Shape } else { Detail::Attributes };
    carried.detail().max(selecting).max(weights::detail(&args.weights))
}

fn for_views(args: &ForViewsArgs) -> Option<ForViews> {
    let cameras = args.view_from.map_or(Cameras::Around, |toward| Cameras::Cone {
        toward,
        angle: args.view_angle.to_radians(),
        distance: args.view_distance,
    });
    args.for_views.then(|| ForViews { cameras, views: args.views, ..ForViews::default() })
}

/// How points are wrapped, whatever their number.
pub(crate) fn wrap_options(segment: &SegmentArgs, points: &SequenceArgs) -> Outcome<Options> {
    let (sequence, seed) = sequence(points)?;
    Ok(Options {
        segment: segment_options(segment),
        sequence,
        seed,
        tolerance: points.tolerance,
        ..Options::default()
    })
}

/// Refuses more points than fit in the memory allowed, by what runs took: 1,000,000 to 10,000,000 points wrapped with each
/// sequence, and 300,000 equalized.
pub(crate) fn points_fit(
    options: &Options,
    held: Held,
    area: f64,
    reading: &ReadingArgs,
) -> anyhow::Result<()> {
    let most = reading.memory();
    let n = match options.request {
        Request::Count(n) => n as f64,
        Request::Density(density) => density * area,
        Request::Spacing(spacing) => area / (spacing * spacing),
        // Only wrapping tells how many.
        Request::Irregularity(_) => return Ok(()),
    };
    let (each, advice) = match (options.equalize, held, options.sequence) {
        (Some(_), _, _) => (7_200.0, ", or leave equalizing out (--no-equalize), which takes most"),
        (None, Held::All, _) => {
            (500.0, ", or write .ply, .xyz, .csv, .npy or .json alone, without cell areas")
        }
        (None, Held::Block, Sequence::Hammersley { .. }) => (60.0, ""),
        // All their points on the domain are listed.
        (None, Held::Block, _) => (300.0, ", or take --sequence hammersley"),
    };
    if n * each <= most as f64 {
        return Ok(());
    }
    Err(anyhow::anyhow!(
        "{n:.0} points take about {:.0} MB of memory, but {} {:.0}: ask for fewer points, raise --max-memory{advice}",
        n * each / 1e6,
        match reading.max_memory {
            Some(_) => "--max-memory allows",
            None => "without --max-memory no more are taken than",
        },
        most as f64 / 1e6
    ))
}

fn request(args: &RequestArgs) -> Request {
    // The number for --per-component is known when the mesh is.
    let RequestArgs { count, density, spacing, irregularity, per_component: _ } = *args;
    count
        .map(|n| Request::Count(n as usize))
        .or(density.map(Request::Density))
        .or(spacing.map(Request::Spacing))
        .or(irregularity.map(Request::Irregularity))
        .unwrap_or(Options::default().request)
}

/// How the surface is cut.
pub(crate) fn segment_options(args: &SegmentArgs) -> SegmentOptions {
    SegmentOptions {
        flatness_angle: args.flatness_angle.to_radians(),
        smallest_share: args.smallest_share,
        order: args.growth.into(),
    }
}

/// The sequence, and the seed that shifts it.
pub(crate) fn sequence(args: &SequenceArgs) -> Outcome<(Sequence, u64)> {
    let (sequence, seed) = match (args.sequence, args.bases.as_deref()) {
        (SequenceArg::Hammersley, None) => (Sequence::Hammersley { base: 2 }, args.seed),
        (SequenceArg::Hammersley, Some(&[base])) => (Sequence::Hammersley { base }, args.seed),
        (SequenceArg::Hammersley, Some(_)) => {
            return Err(Failure::wrong_use("--sequence hammersley has one base: give --bases A"));
        }
        (SequenceArg::Halton, None) => (Sequence::Halton { bases: [2, 3] }, args.seed),
        (SequenceArg::Halton, Some(&[a, b])) => (Sequence::Halton { bases: [a, b] }, args.seed),
        (SequenceArg::Halton, Some(_)) => {
            return Err(Failure::wrong_use("--sequence halton has two bases: give --bases A,B"));
        }
        // A seed scrambles Sobol' points anew, which is better than shifting them.
        (SequenceArg::Sobol, None) => (Sequence::Sobol { seed: args.seed }, 0),
        (SequenceArg::R2, None) => (Sequence::R2, args.seed),
        (SequenceArg::Fibonacci, None) => (Sequence::Fibonacci, args.seed),
        (SequenceArg::Sobol | SequenceArg::R2 | SequenceArg::Fibonacci, Some(_)) => {
            return Err(Failure::wrong_use("--bases: only hammersley and halton have bases"));
        }
    };
    sequence.validate().map_err(|error| Failure::wrong_use(format!("--bases: {error}")))?;
    Ok((sequence, seed))
}

/// `count` seeds from `first` on; at least one.
pub(crate) fn seeds(first: u64, count: u32) -> Outcome<RangeInclusive<u64>> {
    match first.checked_add(u64::from(count.saturating_sub(1))) {
        Some(last) => Ok(first..=last),
        None => Err(Failure::wrong_use(format!(
            "--seeds: {count} seeds from {first} on go beyond the largest, {}: take a smaller --seed",
            u64::MAX
        ))),
    }
}

/// Refuses a value that is given a second time; `name` makes it readable.
pub(crate) fn refuse_repeated<T: PartialEq>(
    option: &str,
    values: &[T],
    name: impl Fn(&T) -> String,
) -> Outcome {
    let repeated = values.iter().enumerate().find(|(i, value)| values[..*i].contains(value));
    match repeated {
        Some((_, value)) => {
            Err(Failure::wrong_use(format!("{option}: {} is given twice: leave one out", name(value))))
        }
        None => Ok(()),
    }
}
