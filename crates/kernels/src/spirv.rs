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
    /// How far the nearest of each point can be, for many of them.
    bound_reach,
    /// `bound_reach`, reading points through a uniform texel buffer.
    bound_reach_texels,
    /// `bound_reach_texels` for up to 16.
    bound_reach_texels_few,
    /// The camera's ray of each pixel.
    camera_rays,
    /// `camera_rays` for rays in a queue.
    camera_rays_queue,
    /// The first wave from the eye to the film, where rays of a queue need none.
    camera_trace,
    /// `camera_trace` through the tree.
    camera_trace_tree,
    /// Where each cell's entries begin.
    cell_offsets,
    /// What becomes of each ray of a wave.
    classify,
    /// `classify` for rays in a queue.
    classify_queue,
    /// Trust balls that end at rims.
    clip_balls,
    /// Bits set in each word of marks.
    count_marked,
    /// Screen tiles that each disc covers.
    disc_count,
    /// `disc_count` for rays in a queue.
    disc_count_queue,
    /// Pairs of screen tile and point.
    disc_emit,
    /// `disc_emit` for rays in a queue.
    disc_emit_queue,
    /// Where each screen tile's points begin and end.
    disc_ranges,
    /// The nearest hit among the points of a screen tile.
    disc_trace,
    /// `disc_trace` for rays in a queue.
    disc_trace_queue,
    /// The nearest of each point, for many of them.
    find_neighbors,
    /// `find_neighbors`, reading points through a uniform texel buffer.
    find_neighbors_texels,
    /// `find_neighbors_texels` for up to 16.
    find_neighbors_texels_few,
    /// `find_neighbors_texels_few` where no two others are equally far.
    find_neighbors_untied,
    /// The local polynomial of each point.
    fit_polynomials,
    /// The same, reading points through a uniform texel buffer.
    fit_polynomials_texels,
    /// `fit_polynomials_texels` for lists of up to 16.
    fit_polynomials_texels_few,
    /// Boxes of points that the balls of others touch.
    gather_leaves,
    /// The same, reading points and boxes through uniform texel buffers.
    gather_leaves_texels,
    /// Cells that each trust ball meets.
    grid_count,
    /// The same, reading polynomials through a uniform texel buffer.
    grid_count_texels,
    /// Pairs of cell and point.
    grid_emit,
    /// Those of large balls.
    grid_emit_large,
    /// The same, reading polynomials through a uniform texel buffer.
    grid_emit_large_texels,
    /// `grid_emit`, reading polynomials through a uniform texel buffer.
    grid_emit_texels,
    /// Where each cell's points begin and end.
    grid_ranges,
    /// One pass of the traversal.
    grid_trace,
    /// The same for rays that start on surfaces.
    grid_trace_leaving,
    /// `grid_trace_leaving` for rays in a queue.
    grid_trace_leaving_queue,
    /// `grid_trace` for rays in a queue.
    grid_trace_queue,
    /// Cells beside marked ones.
    grow_marks,
    /// Where rays first meet an isosurface.
    isosurface,
    /// `isosurface` for rays in a queue.
    isosurface_queue,
    /// Whether shadow rays meet one.
    isosurface_shadows,
    /// `isosurface_shadows` for rays in a queue.
    isosurface_shadows_queue,
    /// Boxes around points.
    leaf_boxes,
    /// The same, reading points through a uniform texel buffer.
    leaf_boxes_texels,
    /// The rays that are marked, one after another.
    list_marked,
    /// The points of each cell with their positions.
    list_points,
    /// The same, reading polynomials through a uniform texel buffer.
    list_points_texels,
    /// Rays through volumes.
    march,
    /// Rays through volumes that lights shine into.
    march_lit,
    /// `march_lit` for rays in a queue.
    march_lit_queue,
    /// `march` for rays in a queue.
    march_queue,
    /// Shadow rays through volumes.
    march_shadows,
    /// `march_shadows` for rays in a queue.
    march_shadows_queue,
    /// Cells that have points.
    mark_occupied,
    /// Boxes around boxes.
    node_boxes,
    /// Trust balls in the order that the grid lists them in.
    order_balls,
    /// `order_balls`, reading polynomials through a uniform texel buffer.
    order_balls_texels,
    /// What of a light's reaches the points of a volume.
    point_lights,
    /// `point_lights` for rays in a queue.
    point_lights_queue,
    /// Rays from the points of a volume towards a light.
    point_rays,
    /// `point_rays` for rays in a queue.
    point_rays_queue,
    /// One iteration of each pending hit towards the point set surface.
    refine,
    /// `refine` for rays in a queue.
    refine_queue,
    /// Sends rays whose hit was refined away on to the next.
    resume,
    /// `resume` for rays in a queue.
    resume_queue,
    /// Prefix sums, second half.
    scan_apply,
    /// Prefix sums, first half.
    scan_reduce,
    /// Reflected and refracted rays.
    scatter,
    /// `scatter` for rays in a queue.
    scatter_queue,
    /// Lambert's law at the diffuse hits.
    shade,
    /// `shade` for rays in a queue.
    shade_queue,
    /// Shadow rays on the other side of surfaces that let them through.
    shadow_go_on,
    /// `shadow_go_on` for rays in a queue.
    shadow_go_on_queue,
    /// What shadow rays start inside.
    shadow_media,
    /// `shadow_media` for rays in a queue.
    shadow_media_queue,
    /// What the surfaces that shadow rays have met do to light.
    shadow_meet,
    /// `shadow_meet` for rays in a queue.
    shadow_meet_queue,
    /// Rays towards a light.
    shadow_rays,
    /// `shadow_rays` for rays in a queue.
    shadow_rays_queue,
    /// Discs as polynomials.
    shape_discs,
    /// Spheres as polynomials.
    shape_spheres,
    /// How far empty cells are from others.
    skip_cells,
    /// Feature sizes as means over neighbours.
    smooth_sizes,
    /// The same, reading points through a uniform texel buffer.
    smooth_sizes_texels,
    /// Stable sort by one digit, first half.
    sort_count,
    /// Stable sort by one digit, second half.
    sort_scatter,
    /// Where each ray met the polynomial it hit.
    surface_hit,
    /// `surface_hit` for rays in a queue.
    surface_hit_queue,
    /// The same as `tree_nodes`, around the surfaces of points.
    tree_leaves,
    /// Nodes of one level of the tree.
    tree_nodes,
    /// One pass of the traversal of the tree.
    tree_trace,
    /// `tree_trace` for rays that start on surfaces.
    tree_trace_leaving,
}

/// Modules made of another kernel's source with macros defined: name, kernel, macros.
pub const VARIANTS: &[(&str, &str, &[&str])] = &[
    ("bound_reach_texels", "bound_reach", &["POINTS_AS_TEXELS"]),
    ("bound_reach_texels_few", "bound_reach", &["POINTS_AS_TEXELS", "FEW"]),
    ("camera_rays_queue", "camera_rays", &["QUEUE"]),
    ("camera_trace_tree", "camera_trace", &["TREE"]),
    ("classify_queue", "classify", &["QUEUE"]),
    ("disc_count_queue", "disc_count", &["QUEUE"]),
    ("disc_emit_queue", "disc_emit", &["QUEUE"]),
    ("disc_trace_queue", "disc_trace", &["QUEUE"]),
    ("find_neighbors_texels", "find_neighbors", &["POINTS_AS_TEXELS"]),
    ("find_neighbors_texels_few", "find_neighbors", &["POINTS_AS_TEXELS", "FEW"]),
    ("find_neighbors_untied", "find_neighbors", &["POINTS_AS_TEXELS", "FEW", "UNTIED"]),
    ("fit_polynomials_texels", "fit_polynomials", &["POINTS_AS_TEXELS"]),
    ("fit_polynomials_texels_few", "fit_polynomials", &["POINTS_AS_TEXELS", "FEW"]),
    ("gather_leaves_texels", "gather_leaves", &["POINTS_AS_TEXELS"]),
    ("grid_count_texels", "grid_count", &["POINTS_AS_TEXELS"]),
    ("grid_emit_large_texels", "grid_emit_large", &["POINTS_AS_TEXELS"]),
    ("grid_emit_texels", "grid_emit", &["POINTS_AS_TEXELS"]),
    ("grid_trace_leaving", "grid_trace", &["LEAVES"]),
    ("grid_trace_leaving_queue", "grid_trace", &["LEAVES", "QUEUE"]),
    ("grid_trace_queue", "grid_trace", &["QUEUE"]),
    ("isosurface_queue", "isosurface", &["QUEUE"]),
    ("isosurface_shadows", "isosurface", &["SHADOWS"]),
    ("isosurface_shadows_queue", "isosurface", &["SHADOWS", "QUEUE"]),
    ("leaf_boxes_texels", "leaf_boxes", &["POINTS_AS_TEXELS"]),
    ("list_points_texels", "list_points", &["POINTS_AS_TEXELS"]),
    ("march_lit", "march", &["LIT"]),
    ("march_lit_queue", "march", &["LIT", "QUEUE"]),
    ("march_queue", "march", &["QUEUE"]),
    ("march_shadows", "march", &["SHADOWS"]),
    ("march_shadows_queue", "march", &["SHADOWS", "QUEUE"]),
    ("order_balls_texels", "order_balls", &["POINTS_AS_TEXELS"]),
    ("point_lights_queue", "point_lights", &["QUEUE"]),
    ("point_rays_queue", "point_rays", &["QUEUE"]),
    ("refine_queue", "refine", &["QUEUE"]),
    ("resume_queue", "resume", &["QUEUE"]),
    ("scatter_queue", "scatter", &["QUEUE"]),
    ("shade_queue", "shade", &["QUEUE"]),
    ("shadow_go_on_queue", "shadow_go_on", &["QUEUE"]),
    ("shadow_media_queue", "shadow_media", &["QUEUE"]),
    ("shadow_meet_queue", "shadow_meet", &["QUEUE"]),
    ("shadow_rays_queue", "shadow_rays", &["QUEUE"]),
    ("smooth_sizes_texels", "smooth_sizes", &["POINTS_AS_TEXELS"]),
    ("surface_hit_queue", "surface_hit", &["QUEUE"]),
    ("tree_leaves", "tree_nodes", &["LEAVES"]),
    ("tree_trace_leaving", "tree_trace", &["LEAVES"]),
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
