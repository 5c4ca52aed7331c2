"""Our materials as Mitsuba BSDFs, and those of them that Mitsuba 3 lacks. Import this module when a variant is chosen: their base class
exists only then."""
import drjit as dr
import mitsuba as mi
import numpy as np

from references.mitsuba_scene import colour, load_image


class ByEvalPdf(mi.BSDF):
    """Implements eval() and pdf() with eval_pdf()."""

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]


class Nested(ByEvalPdf):
    """Changes what another BSDF does."""

    def __init__(self, properties):
        super().__init__(properties)
        self.nested = properties["nested"]
        self.m_components = [self.nested.flags(i) for i in range(self.nested.component_count())]
        self.m_flags = self.nested.flags()


class Opaque(ByEvalPdf):
    """Reflects light from a texture "diffuse", and by a lobe; sample_direction() chooses between both."""

    def __init__(self, properties):
        super().__init__(properties)
        self.diffuse = properties.get_texture("diffuse")
        self.m_components = [
            mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide,
            mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide,
        ]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def sample(self, ctx, si, sample1, sample2, active=True):
        sample = dr.zeros(mi.BSDFSample3f)
        sample.wo = self.sample_direction(ctx, si, sample1, sample2, active)
        value, sample.pdf = self.eval_pdf(ctx, si, sample.wo, active)
        sample.eta = 1
        sample.sampled_type = mi.UInt32(+self.m_flags)
        return sample, dr.select(sample.pdf > 0, value / dr.maximum(sample.pdf, 1e-20), 0)


class InterpolatedNormals(Nested):
    """Another BSDF in the frame of interpolated normals, which the mesh has as attribute vertex_shading_normal.

    Mitsuba's own vertex normals also turn the front of emitters and the area of light sources. Ours shade only:
    a direction on opposite sides of the interpolated normal and of the triangle carries nothing.
    """

    def turn(self, si, active):
        """The interaction in the frame of the interpolated normal, and whether wi is on the same side of both normals."""
        normal = mi.Vector3f(si.shape.eval_attribute_3("vertex_shading_normal", si, active))
        length = dr.norm(normal)
        turned = mi.SurfaceInteraction3f(si)
        turned.sh_frame = mi.Frame3f(dr.select(length > 0, normal / dr.maximum(length, 1e-20), mi.Vector3f(si.n)))
        turned.wi = turned.to_local(si.to_world(si.wi))
        return turned, active & (turned.wi.z * si.wi.z > 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        turned, active = self.turn(si, active)
        sample, weight = self.nested.sample(ctx, turned, sample1, sample2, active)
        z = sample.wo.z
        sample.wo = si.to_local(turned.to_world(sample.wo))
        active &= z * sample.wo.z > 0
        return sample, dr.select(active, weight, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        turned, active = self.turn(si, active)
        turned_wo = turned.to_local(si.to_world(wo))
        active &= turned_wo.z * wo.z > 0
        value, pdf = self.nested.eval_pdf(ctx, turned, turned_wo, active)
        return dr.select(active, value, 0), dr.select(active, pdf, 0)


class Phong(Opaque):
    """Kd / pi + Ks (n + 2) / (2 pi) cos^n(alpha), alpha between wo and the mirror image of wi: normalised Phong."""

    def __init__(self, properties):
        super().__init__(properties)
        self.specular, self.exponent = properties.get_texture("specular"), properties["exponent"]

    def lobe_albedos(self, si, active):
        """Kd, Ks, and the probability of sampling the glossy lobe."""
        diffuse, specular = self.diffuse.eval(si, active), self.specular.eval(si, active)
        sum_diffuse, sum_specular = dr.sum(diffuse), dr.sum(specular)
        return diffuse, specular, sum_specular / dr.maximum(sum_diffuse + sum_specular, 1e-20)

    def sample_direction(self, ctx, si, sample1, sample2, active):
        _, _, probability = self.lobe_albedos(si, active)
        # cos^(n+1) alpha is uniform. With the square t of tan(alpha / 2) nothing cancels for small alpha.
        t = dr.tanh(-0.5 * dr.log(1 - sample2.x) / (self.exponent + 1))
        phi = 2 * dr.pi * sample2.y
        lobe = mi.Vector3f(2 * dr.sqrt(t) * dr.cos(phi), 2 * dr.sqrt(t) * dr.sin(phi), 1 - t) / (1 + t)
        return dr.select(
            sample1 < probability, mi.Frame3f(mi.reflect(si.wi)).to_world(lobe), mi.warp.square_to_cosine_hemisphere(sample2)
        )

    def eval_pdf(self, ctx, si, wo, active=True):
        active &= (si.wi.z > 0) & (wo.z > 0)
        diffuse, specular, probability = self.lobe_albedos(si, active)
        # cos^n alpha, with 1 - cos alpha computed accurately.
        one_minus_cos = 0.5 * dr.squared_norm(mi.reflect(si.wi) - wo)
        in_front = dr.minimum(one_minus_cos, 1 - 1e-6)  # where the division and the logarithm have a value
        power = dr.exp(-2 * self.exponent * dr.atanh(in_front / (2 - in_front)))
        lobe = dr.select(one_minus_cos < 1, power, 0) / (2 * dr.pi)
        value = (diffuse / dr.pi + specular * (self.exponent + 2) * lobe) * wo.z
        pdf = (1 - probability) * wo.z / dr.pi + probability * (self.exponent + 1) * lobe
        return dr.select(active, value, 0), dr.select(active, pdf, 0)


def correlation(alpha, wi, wo):
    """Height-correlated masking-shadowing divided by the product of both sides', which Mitsuba uses. Either direction may lie
    in the surface: a scalar variant divides by no 0."""
    z_i, z_o = dr.abs(wi.z), dr.abs(wo.z)
    root_i, root_o = (dr.sqrt(dr.square(z) + alpha**2 * dr.maximum(1 - dr.square(z), 0)) for z in (z_i, z_o))
    return (z_i + root_i) * (z_o + root_o) / dr.maximum(2 * (z_o * root_i + z_i * root_o), 1e-20)


class RoughGlass(Nested):
    """Mitsuba's rough dielectric, with height-correlated masking-shadowing for reflection."""

    def __init__(self, properties):
        super().__init__(properties)
        self.alpha = properties["alpha"]

    def correct(self, value, wi, wo):
        return dr.select(wi.z * wo.z > 0, value * correlation(self.alpha, wi, wo), value)

    def sample(self, ctx, si, sample1, sample2, active=True):
        sample, weight = self.nested.sample(ctx, si, sample1, sample2, active)
        return sample, self.correct(weight, si.wi, sample.wo)

    def eval_pdf(self, ctx, si, wo, active=True):
        value, pdf = self.nested.eval_pdf(ctx, si, wo, active)
        return self.correct(value, si.wi, wo), pdf


class RoughOpaque(Opaque):
    """Rough metal, by Mitsuba's rough conductor without Fresnel, and a diffuse surface under a rough coat (Kelemen and
    Szirmay-Kalos 2001), whose albedo is a sum over facet normals."""

    def __init__(self, properties):
        super().__init__(properties)
        self.facets, self.metalness, self.index, self.alpha = (
            properties[name] for name in ("facets", "metalness", "index", "alpha")
        )
        self.facet_probability = 0.5 + 0.5 * self.metalness
        cosines = np.linspace(0, 1, 257) ** 2
        albedo = np.array([self.coat_albedo(max(cosine, 1e-6)) for cosine in cosines])
        weighted = albedo * cosines
        self.mean_albedo = float(((weighted[1:] + weighted[:-1]) * np.diff(cosines)).sum())  # by trapezoids, times 2
        self.albedo = mi.Float(albedo.astype(np.float32)) if dr.is_array_v(mi.Float) else albedo.tolist()

    def coat_albedo(self, cosine, count=200):
        """Averaged over normals distributed like D n m."""
        u, phi = np.meshgrid(1 - (1 - (np.arange(count) + 0.5) / count) ** 3, np.pi * (np.arange(count) + 0.5) / count)
        tangent = self.alpha * np.sqrt(u / (1 - u))
        m_z = 1 / np.sqrt(1 + tangent**2)
        m_o = m_z * (tangent * np.cos(phi) * np.sqrt(1 - cosine**2) + cosine)
        z = 2 * m_o * m_z - cosine
        seen = (m_o > 0) & (z > 0)
        m_o, z = np.where(seen, m_o, 1), np.where(seen, z, 1)
        refracted = np.sqrt(self.index**2 - 1 + m_o**2)
        fresnel = 0.5 * (
            ((m_o - refracted) / (m_o + refracted)) ** 2
            + ((self.index**2 * m_o - refracted) / (self.index**2 * m_o + refracted)) ** 2
        )

        def term(c):
            return 0.5 * (np.sqrt(1 + self.alpha**2 * (1 / c**2 - 1)) - 1)

        part = fresnel * m_o / (cosine * m_z * (1 + term(cosine) + term(z)))
        return (np.where(seen, part, 0) * 3 * (1 - u) ** (2 / 3)).mean()

    def absorbed(self, cosine):
        """The fraction of light from this direction that the coat does not reflect."""
        position = dr.sqrt(dr.clip(cosine, 0, 1)) * 256
        if not dr.is_array_v(mi.Float):
            return 1 - np.interp(position, np.arange(257), self.albedo)
        i = dr.minimum(mi.UInt32(position), 255)
        return 1 - dr.lerp(dr.gather(mi.Float, self.albedo, i), dr.gather(mi.Float, self.albedo, i + 1), position - i)

    def sample_direction(self, ctx, si, sample1, sample2, active):
        facet_sample, _ = self.facets.sample(ctx, si, sample1, sample2, active)
        return dr.select(sample1 < self.facet_probability, facet_sample.wo, mi.warp.square_to_cosine_hemisphere(sample2))

    def eval_pdf(self, ctx, si, wo, active=True):
        active &= (si.wi.z > 0) & (wo.z > 0)
        colour = self.diffuse.eval(si, active)
        facets, facet_pdf = self.facets.eval_pdf(ctx, si, wo, active)
        cosine = dr.dot(wo, dr.normalize(wo + si.wi))
        coat = mi.fresnel(cosine, self.index)[0]
        fresnel = dr.lerp(mi.Color3f(coat), colour + (1 - colour) * (1 - cosine) ** 5, self.metalness)
        diffuse = self.absorbed(si.wi.z) * self.absorbed(wo.z) / (dr.pi * (1 - self.mean_albedo))
        value = fresnel * facets * correlation(self.alpha, si.wi, wo) + (1 - self.metalness) * colour * diffuse * wo.z
        pdf = self.facet_probability * facet_pdf + (1 - self.facet_probability) * wo.z / dr.pi
        return dr.select(active, value, 0), dr.select(active, pdf, 0)


mi.register_bsdf("rough_glass", RoughGlass)
mi.register_bsdf("rough_opaque", RoughOpaque)
mi.register_bsdf("interpolated_normals", InterpolatedNormals)
mi.register_bsdf("phong_lobe", Phong)


def make_diffuse_reflectance(material):
    if material.texture is None:
        return colour(material.diffuse_albedo)
    pixels = (material.diffuse_albedo * load_image(material.texture)).astype(np.float32)
    return {
        "type": "bitmap",
        "data": mi.TensorXf(np.ascontiguousarray(pixels)),
        "raw": True,
        "format": "variant",
        "filter_type": "bilinear",
        "wrap_mode": "repeat",
    }


def make_bsdf(surface, own_normals):
    material = surface.material
    if surface.is_open:
        return {"type": "null"}
    if material.roughness > 0 and material.refractive_index > 0:
        bsdf = {
            "type": "rough_glass",
            "alpha": material.roughness,
            "nested": {
                "type": "roughdielectric",
                "distribution": "ggx",
                "alpha": material.roughness,
                "int_ior": material.refractive_index,
                "ext_ior": 1.0,
            },
        }
    elif material.roughness > 0:
        bsdf = {
            "type": "twosided",
            "nested": {
                "type": "rough_opaque",
                "diffuse": make_diffuse_reflectance(material),
                "metalness": material.metalness,
                "index": material.coat_index,
                "alpha": material.roughness,
                "facets": {"type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": material.roughness},
            },
        }
    elif material.refractive_index > 0:
        bsdf = {"type": "dielectric", "int_ior": material.refractive_index, "ext_ior": 1.0}
    elif material.specular_albedo.any():
        bsdf = {
            "type": "twosided",
            "nested": {
                "type": "phong_lobe",
                "diffuse": make_diffuse_reflectance(material),
                "specular": colour(material.specular_albedo),
                "exponent": material.specular_exponent,
            },
        }
    else:
        bsdf = {"type": "twosided", "nested": {"type": "diffuse", "reflectance": make_diffuse_reflectance(material)}}
    is_left_alone = surface.normals is None or own_normals
    return bsdf if is_left_alone else {"type": "interpolated_normals", "nested": bsdf}
