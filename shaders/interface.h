// Structs and constants that C++ and GLSL share: each is written once, here. Both sides use scalar block
// layout.
#ifndef INTERFACE_H
#define INTERFACE_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace lab {
using glm::mat3;
using glm::mat4x3;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = glm::uint;
#define SHARED_CONSTANT inline constexpr uint
#define SHARED_NUMBER inline constexpr float
#else
#define SHARED_CONSTANT const uint
#define SHARED_NUMBER const float
#endif

// Descriptor set 0. Bindings whose scene feature is absent are neither declared nor allocated.
SHARED_CONSTANT BINDING_RENDER_PARAMETERS = 0u;
SHARED_CONSTANT BINDING_FILM = 1u;
SHARED_CONSTANT BINDING_RAY_COUNTERS = 2u;
SHARED_CONSTANT BINDING_POSITIONS = 3u;
SHARED_CONSTANT BINDING_TRIANGLES = 4u;
SHARED_CONSTANT BINDING_TRIANGLE_MATERIALS = 5u;
SHARED_CONSTANT BINDING_MATERIALS = 6u;
SHARED_CONSTANT BINDING_NORMALS = 7u;
SHARED_CONSTANT BINDING_TEXTURE_COORDINATES = 8u;
SHARED_CONSTANT BINDING_INSTANCES = 9u;
SHARED_CONSTANT BINDING_TEXTURES = 10u;
SHARED_CONSTANT BINDING_LIGHT_PROBE = 11u;
SHARED_CONSTANT BINDING_BVH_NODES = 12u;
SHARED_CONSTANT BINDING_BVH_TRIANGLES = 13u;
SHARED_CONSTANT BINDING_ACCELERATION_STRUCTURE = 14u;
SHARED_CONSTANT BINDING_GEOMETRY_FIRST_TRIANGLES = 15u;
SHARED_CONSTANT BINDING_LIGHT_TRIANGLES = 16u;
SHARED_CONSTANT BINDING_PICTURE = 17u;
SHARED_CONSTANT BINDING_LARGEST_VALUE = 18u;
SHARED_CONSTANT BINDING_SAMPLES = 19u;
SHARED_CONSTANT BINDING_OTHER_SIDES = 20u;
SHARED_CONSTANT BINDING_PROBE_CELLS = 21u;
SHARED_CONSTANT BINDING_TEXTURE_SIZES = 22u;
SHARED_CONSTANT BINDING_MICROFACETS = 23u;
SHARED_CONSTANT BINDING_MEDIA = 24u;
SHARED_CONSTANT BINDING_BOUNDARIES = 25u;
SHARED_CONSTANT BINDING_DENSITIES = 26u;
SHARED_CONSTANT BINDING_LIGHT_NODES = 27u;
SHARED_CONSTANT BINDING_LIGHT_LEAVES = 28u;
SHARED_CONSTANT BINDING_LIGHT_PLACES = 29u;
SHARED_CONSTANT BINDING_BOUNDARY_PLACES = 30u;
SHARED_CONSTANT BINDING_OVERLAPS = 31u;
SHARED_CONSTANT BINDING_SPLATS = 34u;  // 32 and 33 are those of world_triangles.h
SHARED_CONSTANT BINDING_FILTER_FILMS = 35u;
SHARED_CONSTANT BINDING_FILTER_INPUT = 36u;
SHARED_CONSTANT BINDING_FILTER_OUTPUT = 37u;

// How light scatters at a surface. The ray tracing pipeline has a hit group for each class that a scene uses.
SHARED_CONSTANT MATERIAL_CLASS_DIFFUSE = 0u;
SHARED_CONSTANT MATERIAL_CLASS_DIELECTRIC = 1u;

// A workgroup renders samples of a block of BLOCK_WIDTH x BLOCK_HEIGHT pixels.
SHARED_CONSTANT BLOCK_WIDTH = 8u;
SHARED_CONSTANT BLOCK_HEIGHT = 8u;
SHARED_CONSTANT BLOCK_SIZE = BLOCK_WIDTH * BLOCK_HEIGHT;  // pixels

// Ray counts are spread over this many counters, so that atomic additions rarely contend.
SHARED_CONSTANT RAY_COUNTER_COUNT = 64u;

// How an estimator finds light.
SHARED_CONSTANT STRATEGY_BOTH = 0u;     // a STRATEGY: light samples and bounces, weighted
SHARED_CONSTANT STRATEGY_LIGHT = 1u;    // a STRATEGY: light samples alone
SHARED_CONSTANT STRATEGY_BOUNCES = 2u;  // a STRATEGY: bounces alone

// What a triangle is made of, from MTL. Reflectances are linear, in [0,1]; diffuse + specular is at most 1.
struct Material {
    vec3 diffuse_albedo;      // Kd
    int albedo_texture;       // map_Kd: index into the textures that multiply diffuse_albedo, or -1
    vec3 emission;            // Ke: emitted radiance, from the front only
    float specular_exponent;  // Ns: exponent n of the normalised Phong lobe
    vec3 specular_albedo;     // Ks: zero unless the scene asks for `specular`
    float refractive_index;   // Ni of a smooth dielectric (d < 1), or 0 for an opaque surface
    vec3 absorption;          // sigma = -ln Tf per unit of world length inside a dielectric
    float light_density;      // density of light samples on it, with respect to area; set by build_light_table()
};

// Directions at which the albedo of microfacets is tabulated: entry i of n is for the cosine (i / (n-1))².
SHARED_CONSTANT MICROFACET_ALBEDO_COUNT = 64u;

// The microfacets of a material, see common/scene/microfacets.h.
struct Microfacets {
    float roughness;                       // α = Pr² of the GGX distribution; 0 for a material without microfacets
    float metalness;                       // Pm
    float coat_index;                      // refractive index of the coat on an opaque material
    vec2 albedo[MICROFACET_ALBEDO_COUNT];  // reflectance of a single bounce: of the coat, and with F = 1
    vec2 mean_albedo;                      // the same under uniform light from all directions
};

// What fills a volume and scatters light: fog, milk, smoke.
struct Medium {
    float extinction;  // collisions per unit of world length where the density is 1; 0 is vacuum
    vec3 albedo;       // fraction of the light that a collision scatters, in [0,1]; the rest is absorbed
    float anisotropy;  // mean cosine of the angle by which a collision turns light, in (-1,1)
    // The density is 1, or it comes from a grid: known at the centres of cells, trilinear in between, 0 outside of its box.
    uvec3 grid_size;        // cells along each axis; 0 without a grid
    uint first_density;     // index of its first cell
    float largest_density;  // of all its cells
    vec3 low;               // corner of the box in the world
    vec3 high;              // the opposite corner
};

// What becomes of the medium that a path is in where it meets a triangle.
SHARED_CONSTANT BOUNDARY_NONE = 0u;   // a surface
SHARED_CONSTANT BOUNDARY_GLASS = 1u;  // what its glass refracts gets to its other side
SHARED_CONSTANT BOUNDARY_OPEN = 2u;   // no surface at all: everything goes on

// Where a body ends, and the media on its two sides, see common/scene/bodies.h. A medium's index is also that of the body which
// it fills: the smaller a body, the larger its index.
struct Boundary {
    uint kind;           // one of the constants above
    uint body;           // the one that ends here
    uint behind;         // index into the media, behind its front
    uint before;         // the same before it
    uint first_overlap;  // of the bodies that may contain parts of it, but not all of it
    uint end_overlaps;   // behind the last one
};

// One placement of a mesh in the world.
struct Instance {
    mat4x3 object_to_world;  // columns: images of the axes, then the translation
    mat3 normal_to_world;    // inverse transpose of the linear part: keeps the front side, mirrored or not
};

// An emissive triangle in the alias table of all of them, see common/scene/light_table.h.
struct LightTriangle {
    uint instance;          // index into the scene's placements of meshes
    uint triangle;          // index into the scene's triangles
    uint threshold;         // this entry is chosen if a random 32-bit word is below this, else its `alias`
    uint alias;             // index into the table
    float inverse_density;  // A/P: area in square scene units over the probability of being chosen
};

// A node of the tree over emissive triangles, see common/scene/light_tree.h: what it knows of each of its four children. A place
// without a child has no power. All powers have the squared radius of all triangles as a factor, so that every quotient stays in
// the range of float.
struct LightNode {
    vec4 centre_x;       // x of the centre of a sphere around the child's triangles, in world space
    vec4 centre_y;       // its y
    vec4 centre_z;       // its z
    vec4 radius;         // of the sphere, in scene units
    vec4 mean_normal_x;  // x of the mean normal of the triangles, weighted by power: shorter than 1 where they disagree
    vec4 mean_normal_y;  // its y
    vec4 mean_normal_z;  // its z
    vec4 spread;         // the largest distance between it and the unit normal of a triangle
    vec4 power;          // area times luminance, as a share of the scene's, times the squared radius of all triangles
    uvec4 child;         // the child's index; of a leaf, IS_LIGHT_LEAF + index of its LightTriangle
};
// From this number on a child of a LightNode is a leaf.
SHARED_CONSTANT IS_LIGHT_LEAF = 0x80000000u;

// What a ray that hits an emissive triangle needs to know of its leaf.
struct LightLeaf {
    uint trail;  // the way down from the root, two bits for each node, the lowest first: which of its children is next
    float area;  // of the triangle, in square scene units
};

// A cell of the light probe in the alias table of all of them, see common/scene/light_table.h.
struct ProbeCell {
    uint threshold;  // as in LightTriangle
    uint alias;
    float density;  // of the cell's directions with respect to solid angle
};

// The fraction of light samples that go to the probe where a scene has both; the rest go to light triangles.
// At one half, neither is more than twice as noisy as alone, whatever the scene.
SHARED_NUMBER LIGHT_PROBE_PROBABILITY = 0.5f;

// Largest number of cells of a light probe: in larger probes a cell covers several texels.
SHARED_CONSTANT MAX_PROBE_CELL_COLUMNS = 4096u;
SHARED_CONSTANT MAX_PROBE_CELL_ROWS = 2048u;

// A camera: with a pinhole, the ray through image position (s, t) in [-1,1]^2 (t down) is forward + s right - t up.
struct Camera {
    vec3 position;          // of the pinhole, or of the middle of the lens
    vec3 forward;           // unit length
    vec3 right;             // scaled by tan(horizontal field of view / 2)
    vec3 up;                // scaled by tan(vertical field of view / 2)
    float aperture_radius;  // of the lens; 0 is a pinhole
    float focus_distance;   // of the plane in focus, along `forward`
};

// Constant during a render.
struct RenderParameters {
    Camera camera;          // where camera rays begin, and where they go
    uvec2 image_size;       // in pixels
    uvec2 seed_key;         // scrambles the start states of the random numbers
    uint first_sample;      // index of this render's first sample in every pixel
    uint max_path_length;   // number of bounces after which a path ends: 0 shows emission only
    int only_path_length;   // counts light only after exactly this many bounces; -1 counts all
    vec3 background;        // radiance of the sky, or the factor of the light probe
    float probe_rotation;   // radians about +Y, counter-clockwise seen from above
    uint splitting_factor;  // number of branches that a path splits into, from chapter 4
    uint roulette_start;    // Russian roulette begins at this bounce, from chapter 5
    float survival_cap;     // largest survival probability, in (0,1], from chapter 5
    float survival_weight;  // throughput that survivors carry, in (0,1], from chapter 5
    float splat_unit;       // of radiance that light paths add to pixels, from chapter 15; 0 without light paths
};

// Brings the pixels of blocks first_block, first_block + 1, ... up to target_samples samples (counted from first_sample), so that
// a render may be cut into dispatches in any way.
struct DispatchParameters {
    uint first_block;
    uint threads_per_pixel;  // 1, unless pixels are shared
    uint samples_per_pixel;  // if they are: the most samples that any pixel still lacks
    uint target_samples;
    uint first_film_pixel;  // where the film's binding begins
};

// What a pixel has accumulated: sum + compensation is the sum of all its finite samples (Kahan summation). Its first, third,
// fifth, … samples and the others form independent halves, even where the samples within a half are correlated: their difference
// estimates the error. It stays small enough to need no compensation.
struct FilmPixel {
    vec3 sum;            // of the samples' radiance
    vec3 compensation;   // what rounding has taken from the sum
    vec3 difference;     // sum of the first, third, … sample minus that of the others
    uint sample_count;   // includes the invalid ones
    uint invalid_count;  // samples that were infinite or not a number; they add 0
};

// Light that light paths send to a pixel: for each of its two halves and each channel a number of 64 bits, the low word first,
// that counts splat_units. Sums of integers do not depend on the order in which threads add. The last word counts what was
// invalid.
SHARED_CONSTANT SPLAT_WORDS = 13u;

// How shaders/engine/display.comp maps radiance to the screen.
struct DisplayParameters {
    uvec2 film_size;          // pixels in use
    uvec2 image_size;         // of the picture; the film is scaled to it
    uint first_film_pixel;    // where the film's binding begins
    uint block_count;         // of the picture
    float scale;              // of radiance
    uint is_srgb;             // 1: encode with the sRGB curve
    uint divides_by_largest;  // 1: divide by the largest value, 2: only look for it
    float splat_unit;         // see SPLAT_WORDS
};

// A pixel of a picture that is being filtered: what the two halves of its samples show, see FilmPixel.
struct FilterPixel {
    vec3 mean[2];      // of each half
    vec3 variance[2];  // of these means
};

// The films that a filter reads: the picture now and with fewer samples, what it shows of emission at the same samples, and what
// its camera rays see.
SHARED_CONSTANT FILM_NOW = 0u;
SHARED_CONSTANT FILM_BEFORE = 1u;           // the same picture with fewer samples
SHARED_CONSTANT FILM_EMISSION = 2u;         // what needs no bounce, at the same samples
SHARED_CONSTANT FILM_EMISSION_BEFORE = 3u;  // what needs no bounce, at the fewer samples
SHARED_CONSTANT FILM_ALBEDO = 4u;           // diffuse albedo that the camera rays see
SHARED_CONSTANT FILM_NORMALS = 5u;          // normals that they see
SHARED_CONSTANT FILTER_FILM_COUNT = 6u;

// A step of shaders/engine/filter_steps.glsl: the first two prepare what is filtered, the last one makes a picture of it.
SHARED_CONSTANT FILTER_STEP_INPUT = 0u;
SHARED_CONSTANT FILTER_STEP_SMOOTH = 1u;
SHARED_CONSTANT FILTER_STEP_PASS = 2u;
SHARED_CONSTANT FILTER_STEP_PICTURE = 3u;
struct FilterParameters {
    uvec2 image_size;  // in pixels
    uint first_block;  // of this dispatch
    uint step;         // one of the constants above
    uint pass;         // of the filter, the first is 0
};

#ifdef __cplusplus
}  // namespace lab
#endif
#endif
