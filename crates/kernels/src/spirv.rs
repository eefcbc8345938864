//! The compiled modules, by the kernel's name.

macro_rules! modules {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {
        /// Names of all modules: stems of `spirv/*.spv`, and, but for [`VARIANTS`], of
        /// `glsl/kernels/*.comp`.
        pub const NAMES: &[&str] = &[$(stringify!($name)),*];

        $($(#[$doc])*
        #[must_use]
        pub fn $name() -> Vec<u32> {
            words(include_bytes!(concat!("../spirv/", stringify!($name), ".spv")))
        })*

        /// The module of a kernel, by its name.
        #[must_use]
        pub fn by_name(name: &str) -> Option<Vec<u32>> {
            match name {
                $(stringify!($name) => Some($name()),)*
                _ => None,
            }
        }
    };
}

modules! {
    /// Adds a sample to each pixel's sum.
    accumulate,
    /// The camera's ray of each pixel.
    camera_rays,
    /// Where each cell's entries begin.
    cell_offsets,
    /// What becomes of each ray of a wave.
    classify,
    /// Trust balls that end at rims.
    clip_balls,
    /// Screen tiles that each disc covers.
    disc_count,
    /// Pairs of screen tile and point.
    disc_emit,
    /// Where each screen tile's points begin and end.
    disc_ranges,
    /// The nearest hit among the points of a screen tile.
    disc_trace,
    /// The same, reading polynomials through a uniform texel buffer.
    disc_trace_texels,
    /// The local polynomial of each point.
    fit_polynomials,
    /// Cells around each trust ball.
    grid_count,
    /// Pairs of cell and point.
    grid_emit,
    /// Where each cell's points begin and end.
    grid_ranges,
    /// One pass of the traversal.
    grid_trace,
    /// The same for rays that start on surfaces.
    grid_trace_leaving,
    /// For those, reading polynomials through a uniform texel buffer.
    grid_trace_leaving_texels,
    /// From the camera, reading polynomials through a uniform texel buffer.
    grid_trace_texels,
    /// Where rays first meet an isosurface.
    isosurface,
    /// Whether shadow rays meet one.
    isosurface_shadows,
    /// The rays that hit a diffuse surface, one after another.
    list_lit,
    /// The rays of a wave that have not ended, one after another.
    list_live,
    /// The points of each cell with their positions.
    list_points,
    /// Rays through volumes.
    march,
    /// Rays through volumes that lights shine into.
    march_lit,
    /// Shadow rays through volumes.
    march_shadows,
    /// Which rays of a wave have not ended.
    mark_live,
    /// What of a light's reaches the points of a volume.
    point_lights,
    /// Rays from the points of a volume towards a light.
    point_rays,
    /// One iteration of each pending hit towards the point set surface.
    refine,
    /// The same, reading points through a uniform texel buffer.
    refine_texels,
    /// Sends rays whose hit was refined away on to the next.
    resume,
    /// Prefix sums, second half.
    scan_apply,
    /// Prefix sums, first half.
    scan_reduce,
    /// Reflected and refracted rays.
    scatter,
    /// Lambert's law at the diffuse hits.
    shade,
    /// Rays towards a light.
    shadow_rays,
    /// Stable sort by one digit, first half.
    sort_count,
    /// Stable sort by one digit, second half.
    sort_scatter,
    /// Where each ray met the polynomial it hit.
    surface_hit,
}

/// Modules made of another kernel's source with macros defined: name, kernel, macros.
pub const VARIANTS: &[(&str, &str, &[&str])] = &[
    ("disc_trace_texels", "disc_trace", &["RECORDS_AS_TEXELS"]),
    ("grid_trace_leaving", "grid_trace", &["LEAVES"]),
    ("grid_trace_leaving_texels", "grid_trace", &["LEAVES", "RECORDS_AS_TEXELS"]),
    ("grid_trace_texels", "grid_trace", &["RECORDS_AS_TEXELS"]),
    ("isosurface_shadows", "isosurface", &["SHADOWS"]),
    ("march_lit", "march", &["LIT"]),
    ("march_shadows", "march", &["SHADOWS"]),
    ("refine_texels", "refine", &["RECORDS_AS_TEXELS"]),
];

/// The kernel whose source a module is made of, and the macros it is compiled with.
#[must_use]
pub fn source_of(name: &str) -> (&str, &'static [&'static str]) {
    VARIANTS
        .iter()
        .find(|variant| variant.0 == name)
        .map_or((name, &[]), |variant| (variant.1, variant.2))
}

/// Words of a module, whatever the alignment of its bytes.
fn words(bytes: &[u8]) -> Vec<u32> {
    bytes
        .chunks_exact(4)
        .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
        .collect()
}
