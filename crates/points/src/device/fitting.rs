//! All fits of a scene, batch after batch: neighbours, and then the polynomials over them.

use super::BuildError;
use super::fit::{FitBuffers, fit_module, record_fits};
use super::search::{BATCH, Search, SearchSpace};
use super::shapes::{ShapeBuffers, write_shapes};
use super::smooth::SmoothSizes;
use super::work::Work;
use crate::{Cloud, NeighborSearch, Rims, Shapes, SlotRange, Watch};
use gpu::{Buffer, Device, GpuError};
use kernels::layout::{FitOutcome, FitParams, Rim};
use kernels::spirv::{Lists, Module};
use std::sync::Arc;

/// The buffers by slot are bound from multiples of so many, which begin where a part of a buffer may.
const BOUND_FROM: u32 = 64;
/// Lists that lie so few places apart are read in one go.
const READ_OVER: usize = 64;

/// What comes of it, beside the polynomials.
pub(crate) struct Fitted {
    /// How each fit ended, by slot.
    pub outcomes: Vec<FitOutcome>,
    /// The same, for kernels.
    pub outcome_buffer: Buffer,
    pub rims: Rims,
    /// Points whose neighbours were found on the host.
    pub searched_on_host: u64,
}

/// Fits batch after batch, so that lists of neighbours never fill memory.
pub(crate) fn fit_all(
    device: &Arc<Device>,
    cloud: &Cloud,
    (fits, shapes): (&[FitParams], &[Shapes]),
    polynomials: &Buffer,
    work: &mut Work,
    watch: &dyn Watch,
) -> Result<Fitted, BuildError> {
    let count = cloud.points.len() as u64;
    let any_smoothed = fits.iter().any(is_smoothed);
    let any_rims = fits.iter().any(|fit| fit.rim_limit > 0.0);
    let lists = lists_of(device, count);
    let of = |asked: bool, count: u64| if asked { count } else { 1 };
    let batch_rims = of(any_rims, count.min(u64::from(BATCH))) * size_of::<Rim>() as u64;
    let outcome_bytes = count * size_of::<FitOutcome>() as u64;
    let mut fitting = Fitting {
        points: Buffer::paged_from_slice(device, "points", &cloud.points)?,
        outcomes: Buffer::paged(device, "fit outcomes", outcome_bytes)?,
        sizes: Buffer::new(device, "feature sizes", 4 * of(any_smoothed, count))?,
        batch_rims: Buffer::new(device, "rims", batch_rims)?,
        rims: Rims::default(),
        searched_on_host: 0,
        lists,
        search: Search::new(device, lists),
        smooth: SmoothSizes::new(device, of(any_smoothed, count), lists)?,
    };
    watch.stage("fitting surfaces", count);
    for fit in fits.iter().filter(|fit| fit.point_count > 0) {
        fitting.object(cloud, fit, polynomials, work, watch)?;
    }
    for fit in shapes.iter().filter_map(Shapes::plane_fit) {
        fitting.object(cloud, &fit, polynomials, work, watch)?;
    }
    let io = ShapeBuffers { points: &fitting.points, polynomials, outcomes: &fitting.outcomes };
    write_shapes(device, work, &io, shapes)?;
    let mut outcomes = vec![FitOutcome { trust: 0.0, kind: 0, feature_size: 0.0 }; count as usize];
    fitting.outcomes.read(0, &mut outcomes)?;
    let Fitting { outcomes: outcome_buffer, rims, searched_on_host, .. } = fitting;
    Ok(Fitted { outcomes, outcome_buffer, rims, searched_on_host })
}

/// The modules that a build with so many neighbours begins with, those first that take longest to compile; so that
/// their pipelines can be [made ahead](gpu::Kernel::make_ahead), while points are still being read.
#[must_use]
pub fn modules_of_fits(device: &Arc<Device>, neighbors: u32) -> Vec<&'static Module> {
    let search = Search::new(device, Lists::Texels).modules(neighbors);
    [vec![fit_module(Lists::Texels, neighbors)], search].concat()
}

/// How a device's kernels read lists of so many texels.
pub(super) fn lists_of(device: &Device, texels: u64) -> Lists {
    let fits = texels <= u64::from(device.limits().max_texel_buffer_elements);
    if fits { Lists::Texels } else { Lists::Storage }
}

/// The k nearest others of each point of a cloud among those of its object, nearest first, `NONE` behind the
/// last: slots, k a point; and of how many points the host found them. What a build does on its way.
///
/// # Errors
/// A device without the memory, a buffer over its limits, a lost device.
pub fn nearest_others(
    device: &Arc<Device>,
    cloud: &Cloud,
    k: u32,
) -> Result<(Vec<u32>, u64), GpuError> {
    let count = cloud.points.len() as u64;
    let lists = lists_of(device, count);
    let points = Buffer::paged_from_slice(device, "points", &cloud.points)?;
    let search = Search::new(device, lists);
    let mut recorder = Work::new(device)?;
    let mut all = Vec::new();
    let mut on_host = 0;
    for object in cloud.objects.iter().filter(|object| object.count > 0) {
        let own = &cloud.points[object.range()];
        let boxes = search.record_boxes(&mut recorder, &points, *object, k)?;
        let most = Search::batch(k);
        let mut space = search.space(object.count.min(most), k)?;
        for first in (0..object.count).step_by(most as usize) {
            let batch = [first, most.min(object.count - first)];
            let host = (own, &mut None);
            on_host += search.find(&mut recorder, &points, &boxes, &mut space, batch, host)?;
            let mut lists = vec![0; (batch[1] * space.stride()) as usize];
            space.lists.read(0, &mut lists)?;
            all.extend(lists.chunks(space.stride() as usize).flat_map(|list| &list[..k as usize]));
        }
    }
    Ok((all, on_host))
}

fn is_smoothed(fit: &FitParams) -> bool {
    fit.feature_size < 0.0
}

/// Buffers and passes of all batches.
struct Fitting {
    points: Buffer,
    outcomes: Buffer,
    /// h by slot, where any object has it smoothed.
    sizes: Buffer,
    batch_rims: Buffer,
    rims: Rims,
    searched_on_host: u64,
    lists: Lists,
    search: Search,
    smooth: SmoothSizes,
}

impl Fitting {
    fn object(
        &mut self,
        cloud: &Cloud,
        fit: &FitParams,
        polynomials: &Buffer,
        rec: &mut Work,
        watch: &dyn Watch,
    ) -> Result<(), BuildError> {
        let object = SlotRange { first_slot: fit.first_slot, count: fit.point_count };
        let own = &cloud.points[object.range()];
        let mut on_host: Option<NeighborSearch<'_>> = None;
        let (search, k) = (&self.search, fit.neighbors);
        let boxes = search.record_boxes(rec, &self.points, object, k)?;
        let most = Search::batch(k);
        let mut space = search.space(object.count.min(most), k)?;
        let rounds = if is_smoothed(fit) { 0..2 } else { 1..2 };
        for round in rounds {
            for first in (0..object.count).step_by(most as usize) {
                if watch.interrupted() {
                    return Err(BuildError::Interrupted);
                }
                let (first_slot, batch) =
                    (object.first_slot + first, [first, most.min(object.count - first)]);
                let host = (own, &mut on_host);
                self.searched_on_host +=
                    self.search.find(rec, &self.points, &boxes, &mut space, batch, host)?;
                if is_smoothed(fit) {
                    let round = [first_slot, batch[1], round];
                    self.smooth.record(rec, &self.points, &space, &self.sizes, round);
                }
                if round == 0 {
                    rec.submit()?;
                    continue;
                }
                let params = FitParams {
                    first_slot,
                    point_count: batch[1],
                    first_listed: first_slot,
                    neighbors: space.stride(),
                    bound_from: first_slot - first_slot % BOUND_FROM,
                    ..*fit
                };
                let io = FitBuffers {
                    points: &self.points,
                    neighbors: &space.lists,
                    polynomials,
                    outcomes: &self.outcomes,
                    sizes: &self.sizes,
                    rims: &self.batch_rims,
                };
                record_fits(rec, self.lists, io, &params);
                rec.submit()?;
                if fit.rim_limit > 0.0 {
                    self.read_rims(first_slot, batch[1], &space)?;
                }
                watch.done(u64::from(first_slot + batch[1]));
            }
        }
        Ok(())
    }

    /// Takes the open points of a batch, with their neighbours: most sets have few, and none but those are
    /// read.
    fn read_rims(
        &mut self,
        first_slot: u32,
        count: u32,
        space: &SearchSpace,
    ) -> Result<(), GpuError> {
        let mut found = vec![Rim::default(); count as usize];
        self.batch_rims.read(0, &mut found)?;
        let stride = space.stride() as usize;
        let open: Vec<usize> = (0..found.len()).filter(|&i| Rims::is_open(&found[i])).collect();
        let mut lists: Vec<u32> = Vec::new();
        for run in open.chunk_by(|a, b| b - a <= READ_OVER) {
            let (Some(&first), Some(&last)) = (run.first(), run.last()) else { continue };
            lists.resize((last + 1 - first) * stride, 0);
            space.lists.read((first * stride * 4) as u64, &mut lists)?;
            for &i in run {
                let list = &lists[(i - first) * stride..][..stride];
                self.rims.add(first_slot + i as u32, &found[i], list);
            }
        }
        Ok(())
    }
}
