//! What is bound: the buffers of a scene, of the rays of a wave, and of volumes.

use crate::RenderError;
use crate::marks::Marks;
use gpu::{Bindings, Buffer, Device, GpuError};
use kernels::layout::{
    CAMERA_FILTER, CAMERA_PATH, CELL_OFFSETS, CELLS, COLORS, ENVIRONMENT_TABLE, FILM, FILM_SUMS,
    FilmPixel, FilmSum, HITS, Hit, IMAGES, ISO_SEARCHES, IsoSearch, LEVELS, LIGHT_SUMS, LIGHTS,
    LISTED_POINTS, LIT_HITS, LIT_MARKS, LIT_RAYS, LIVE, LightSum, LitHit, MARCH_ENDS, MARCH_LIGHTS,
    MARCH_SCATTERS, MARCHES, March, MarchLight, MarchScatter, NEXT_MARKS, NEXT_OFFSETS, OBJECTS,
    OUTCOMES, POLYNOMIALS, Path, SCATTERING_MARKS, SCATTERING_RAYS, SHADOW_PATHS, SLOTS, TALLY,
    TEXELS_OF_IMAGES, VISIBLE, VOLUME_BLOCKS, VOLUME_CELLS, VOLUME_LENGTHS, VOLUME_LIGHTS,
    VOLUME_POINTS, VOLUME_STOPS, VOLUMES, VolumeBlock,
};
use plan::{Plan, Volumes, Window};
use points::device::Surfaces;
use std::sync::Arc;

/// What is counted on the device: hits that sent no ray to a light, reflected rays, and scattered ones.
const TALLIED: usize = 3;

/// What the scene has, none of which changes from pass to pass.
pub(crate) fn of_scene(
    device: &Arc<Device>,
    plan: &Plan,
    surfaces: &Surfaces,
) -> Result<Bindings, RenderError> {
    // An empty buffer there is not.
    let table = match plan.environment_table.as_slice() {
        [] => &[0.0][..],
        table => table,
    };
    let mut table = Bindings::new()
        .buffer(POLYNOMIALS, &surfaces.polynomials)
        .buffer(OUTCOMES, &surfaces.outcome_buffer)
        .buffer(LEVELS, &surfaces.grid_levels)
        .buffer(CELLS, &surfaces.cells)
        .buffer(SLOTS, &surfaces.slots)
        .buffer(OBJECTS, &Buffer::from_slice(device, "objects", &plan.objects)?)
        .buffer(COLORS, &Buffer::from_slice(device, "point colors", &plan.colors)?)
        .buffer(IMAGES, &Buffer::from_slice(device, "images", &plan.images)?)
        .buffer(TEXELS_OF_IMAGES, &texel_buffer(device, plan)?)
        .buffer(ENVIRONMENT_TABLE, &Buffer::from_slice(device, "environment table", table)?)
        .buffer(LIGHTS, &Buffer::from_slice(device, "lights", &plan.lights)?)
        .buffer(CAMERA_FILTER, &Buffer::from_slice(device, "filter", &plan.filter)?);
    if let Some(points) = &surfaces.point_cells {
        table = table.buffer(CELL_OFFSETS, &points.offsets).buffer(LISTED_POINTS, &points.points);
    }
    Ok(table)
}

/// The texels of all images, if the device takes so many.
fn texel_buffer(device: &Arc<Device>, plan: &Plan) -> Result<Buffer, RenderError> {
    let needed = size_of_val(plan.texels.as_slice()) as u64;
    let limit = device.limits().max_storage_buffer_range;
    if needed > limit {
        let images = plan.image_files.join(", ");
        return Err(RenderError::Images { images, needed, limit });
    }
    Ok(Buffer::from_slice(device, "texels", &plan.texels)?)
}

/// What the pixels of a tile saw, and the sums of their samples.
pub(crate) struct FilmBuffers {
    pub film: Buffer,
    /// With one sample a pixel there is nothing to add, and nothing is held.
    sums: Option<Buffer>,
}

impl FilmBuffers {
    pub fn new(device: &Arc<Device>, plan: &Plan) -> Result<Self, GpuError> {
        let pixels = plan.tiles().iter().map(Window::pixels).max().unwrap_or(1) as u64;
        let of = |name, size: usize| Buffer::new(device, name, pixels * size as u64);
        let sums = (plan.samples > 1).then(|| of("film sums", size_of::<FilmSum>()));
        Ok(Self { film: of("film", size_of::<FilmPixel>())?, sums: sums.transpose()? })
    }

    pub fn bind(&self, table: Bindings) -> Bindings {
        let table = table.buffer(FILM, &self.film);
        self.sums.iter().fold(table, |table, sums| table.buffer(FILM_SUMS, sums))
    }
}

/// What the rays of a wave have beside their state, one entry a ray, unless said otherwise.
pub(crate) struct WaveBuffers {
    /// How many rays are not done, and one more count.
    pub live: Buffer,
    pub live_marks: Marks,
    /// The last list of those that live, and the one before.
    pub live_rays: [Buffer; 2],
    pub hits: Buffer,
    /// This wave's, and the next one's.
    paths: [Buffer; 2],
    /// The one that the rays from the camera share.
    camera_path: Buffer,
    /// Of rays that hit a surface that lamps light.
    pub lit: Marks,
    pub lit_rays: Buffer,
    lit_hits: Buffer,
    /// Of rays that hit one that sends rays on.
    pub scattering: Marks,
    pub scattering_rays: Buffer,
    /// Of the rays of the next wave.
    pub next: Marks,
    light_sums: Buffer,
    /// Of shadow rays, where light passes surfaces.
    shadow_paths: Buffer,
    /// The number of each of them.
    every_ray: Buffer,
    pub tally: Buffer,
}

impl WaveBuffers {
    /// For waves of at most so many rays.
    pub fn new(device: &Arc<Device>, plan: &Plan, rays: u32) -> Result<Self, GpuError> {
        let of = |name, count: u32, size: usize| {
            Buffer::new(device, name, u64::from(count) * size as u64)
        };
        // Where no surface sends rays on there is no next wave.
        let next = if plan.scatters() { rays } else { 1 };
        let passing = if plan.light_passes { rays } else { 1 };
        let every_ray: Vec<u32> = (0..passing).collect();
        Ok(Self {
            live: of("live rays", 2, 4)?,
            live_marks: Marks::new(device, rays, false)?,
            live_rays: [of("list of live rays", rays, 4)?, of("list of live rays", rays, 4)?],
            hits: of("hits", rays, size_of::<Hit>())?,
            paths: [
                of("paths", rays, size_of::<Path>())?,
                of("next paths", next, size_of::<Path>())?,
            ],
            camera_path: Buffer::from_slice(device, "camera path", &[plan.camera_path()])?,
            lit: Marks::new(device, rays, false)?,
            lit_rays: of("list of lit rays", rays, 4)?,
            lit_hits: of("lit hits", rays, size_of::<LitHit>())?,
            scattering: Marks::new(device, next, false)?,
            scattering_rays: of("list of scattering rays", next, 4)?,
            next: Marks::new(device, next, true)?,
            light_sums: of("light sums", rays, size_of::<LightSum>())?,
            shadow_paths: of("shadow paths", passing, size_of::<Path>())?,
            every_ray: Buffer::from_slice(device, "list of shadow rays", &every_ray)?,
            tally: of("tally of rays", TALLIED as u32, 4)?,
        })
    }

    /// All that stays where it is; paths do not.
    pub fn bind(&self, table: Bindings) -> Bindings {
        table
            .buffer(LIVE, &self.live)
            .buffer(HITS, &self.hits)
            .buffer(CAMERA_PATH, &self.camera_path)
            .buffer(LIT_MARKS, &self.lit.bits)
            .buffer(LIT_RAYS, &self.lit_rays)
            .buffer(LIT_HITS, &self.lit_hits)
            .buffer(SCATTERING_MARKS, &self.scattering.bits)
            .buffer(SCATTERING_RAYS, &self.scattering_rays)
            .buffer(NEXT_MARKS, &self.next.bits)
            .buffer(NEXT_OFFSETS, &self.next.offsets)
            .buffer(LIGHT_SUMS, &self.light_sums)
            .buffer(SHADOW_PATHS, &self.shadow_paths)
            .buffer(TALLY, &self.tally)
    }

    /// This wave's paths.
    pub fn paths(&self) -> &Buffer {
        &self.paths[0]
    }

    /// Those, or the one that rays share.
    pub fn paths_or_shared(&self, shares: bool) -> &Buffer {
        if shares { &self.camera_path } else { self.paths() }
    }

    /// The next wave's paths.
    pub fn next_paths(&self) -> &Buffer {
        &self.paths[1]
    }

    /// Where the media of shadow rays are, and the list of their places among them: the paths of the wave, or, where light
    /// passes surfaces, which changes them, their own.
    pub fn shadow_media(&self, light_passes: bool) -> [&Buffer; 2] {
        match light_passes {
            false => [self.paths(), &self.lit_rays],
            true => [&self.shadow_paths, &self.every_ray],
        }
    }

    /// Rays that may start at the points of volumes at once.
    pub fn shadow_rays(&self) -> usize {
        (self.light_sums.bytes() / size_of::<LightSum>() as u64) as usize
    }

    /// The next wave is this one.
    pub fn swap(&mut self) {
        self.paths.swap(0, 1);
    }

    /// Hits that sent no ray to a light, reflected and scattered rays, since the tally was zero.
    pub fn read_tally(&self) -> Result<[u64; TALLIED], GpuError> {
        let mut counts = [0u32; TALLIED];
        self.tally.read(0, &mut counts)?;
        Ok(counts.map(u64::from))
    }

    /// The two counts of rays.
    pub fn read_live(&self) -> Result<[u32; 2], GpuError> {
        let mut counts = [0; 2];
        self.live.read(0, &mut counts)?;
        Ok(counts)
    }
}

/// How far the rays of a wave have got through volumes, one entry a ray.
pub(crate) struct VolumeBuffers {
    pub marches: Buffer,
    /// Beside the marches, where volumes are lit.
    pub march_lights: Buffer,
    /// Beside the marches, where volumes scatter rays.
    pub march_scatters: Buffer,
    /// In the search for isosurfaces.
    pub searches: Buffer,
    /// Scalars at places along rays, one entry a ray and volume.
    pub blocks: Buffer,
}

impl VolumeBuffers {
    /// For waves of so many rays, and what the volumes of the scene have; where it has none, nothing is bound.
    pub fn new(
        device: &Arc<Device>,
        volumes: &Volumes,
        rays: u32,
        table: Bindings,
    ) -> Result<(Option<Self>, Bindings), GpuError> {
        if volumes.infos.is_empty() {
            return Ok((None, table));
        }
        let of = |name, needed: bool, count: u64, size: usize| {
            Buffer::new(device, name, if needed { count } else { 1 } * size as u64)
        };
        let rays = u64::from(rays);
        let (lit, points) = (volumes.any_lit(), volumes.points.len() as u64);
        let count = volumes.infos.len() as u64 * volumes.ends_kept();
        let own = Self {
            marches: of("marches", true, rays, size_of::<March>())?,
            march_lights: of("light of marches", lit, rays, size_of::<MarchLight>())?,
            march_scatters: of(
                "scattering of marches",
                volumes.first_cloud.is_some(),
                rays,
                size_of::<MarchScatter>(),
            )?,
            searches: of("searches", volumes.any_isosurface(), rays, size_of::<IsoSearch>())?,
            blocks: of(
                "blocks of places",
                true,
                rays * volumes.infos.len() as u64,
                size_of::<VolumeBlock>(),
            )?,
        };
        let (lengths, stops) = (&volumes.inverse_lengths, &volumes.stops);
        // What steps of each ray end with in each volume; what of each light's reaches each point.
        let ends = of("ends of steps", true, rays * count, if lit { 16 } else { 4 })?;
        let visible = of("visible lights", lit, points, 4 * VOLUME_LIGHTS as usize)?;
        let table = table
            .buffer(VOLUMES, &Buffer::from_slice(device, "volumes", &volumes.with_sizes())?)
            .buffer(
                VOLUME_CELLS,
                &Buffer::paged_from_slice(device, "volume cells", &volumes.cells)?,
            )
            .buffer(
                VOLUME_POINTS,
                &Buffer::paged_from_slice(device, "volume points", &volumes.points)?,
            )
            .buffer(VOLUME_LENGTHS, &Buffer::from_slice(device, "volume lengths", lengths)?)
            .buffer(VOLUME_STOPS, &Buffer::from_slice(device, "transfer functions", stops)?)
            .buffer(MARCHES, &own.marches)
            .buffer(MARCH_ENDS, &ends)
            .buffer(MARCH_LIGHTS, &own.march_lights)
            .buffer(MARCH_SCATTERS, &own.march_scatters)
            .buffer(VISIBLE, &visible)
            .buffer(ISO_SEARCHES, &own.searches)
            .buffer(VOLUME_BLOCKS, &own.blocks);
        Ok((Some(own), table))
    }
}
