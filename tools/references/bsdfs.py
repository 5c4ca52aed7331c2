"""Our materials that Mitsuba 3 lacks, as its BSDFs."""
import drjit as dr
import mitsuba as mi


def define_bsdfs():
    """Defines and registers the classes: their base class exists only after a variant was chosen."""

    class ByEvalPdf(mi.BSDF):
        """eval() and pdf() by eval_pdf()."""

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

    class InterpolatedNormals(ByEvalPdf):
        """Another BSDF in the frame of interpolated normals, which the mesh has as attribute vertex_shading_normal.

        Mitsuba's own vertex normals also turn the front of emitters and the area of light sources. Ours shade only:
        a direction on opposite sides of the interpolated normal and of the triangle carries nothing.
        """

        def __init__(self, properties):
            super().__init__(properties)
            self.nested = properties["nested"]
            self.m_components = [self.nested.flags(i) for i in range(self.nested.component_count())]
            self.m_flags = self.nested.flags()

        def turn(self, si, active):
            """The interaction in the frame of the interpolated normal, and whether wi is on one side of both."""
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

    class Phong(ByEvalPdf):
        """Kd / pi + Ks (n + 2) / (2 pi) cos^n(alpha), alpha between wo and the mirror image of wi: normalised Phong."""

        def __init__(self, properties):
            super().__init__(properties)
            self.diffuse = properties.get_texture("diffuse")
            self.specular = properties.get_texture("specular")
            self.exponent = properties["exponent"]
            self.m_components = [mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide,
                                 mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0] | self.m_components[1]

        def lobe_albedos(self, si, active):
            """Kd, Ks, and the probability of sampling the glossy lobe."""
            diffuse, specular = self.diffuse.eval(si, active), self.specular.eval(si, active)
            sum_diffuse, sum_specular = dr.sum(diffuse), dr.sum(specular)
            return diffuse, specular, sum_specular / dr.maximum(sum_diffuse + sum_specular, 1e-20)

        def sample(self, ctx, si, sample1, sample2, active=True):
            _, _, probability = self.lobe_albedos(si, active)
            # cos^(n+1) alpha is uniform. By the square t of tan(alpha / 2): nothing cancels where alpha is small.
            t = dr.tanh(-0.5 * dr.log(1 - sample2.x) / (self.exponent + 1))
            phi = 2 * dr.pi * sample2.y
            lobe = mi.Vector3f(2 * dr.sqrt(t) * dr.cos(phi), 2 * dr.sqrt(t) * dr.sin(phi), 1 - t) / (1 + t)
            is_glossy = sample1 < probability
            sample = dr.zeros(mi.BSDFSample3f)
            sample.wo = dr.select(is_glossy, mi.Frame3f(mi.reflect(si.wi)).to_world(lobe),
                                  mi.warp.square_to_cosine_hemisphere(sample2))
            value, sample.pdf = self.eval_pdf(ctx, si, sample.wo, active)
            sample.eta = 1
            sample.sampled_type = mi.UInt32(+self.m_flags)
            return sample, value / dr.maximum(sample.pdf, 1e-20)

        def eval_pdf(self, ctx, si, wo, active=True):
            active &= (si.wi.z > 0) & (wo.z > 0)
            diffuse, specular, probability = self.lobe_albedos(si, active)
            # cos^n alpha, where 1 - cos alpha keeps its digits.
            one_minus_cos = 0.5 * dr.squared_norm(mi.reflect(si.wi) - wo)
            power = dr.exp(-2 * self.exponent * dr.atanh(one_minus_cos / (2 - one_minus_cos)))
            lobe = dr.select(one_minus_cos < 1, power, 0) / (2 * dr.pi)
            value = (diffuse / dr.pi + specular * (self.exponent + 2) * lobe) * wo.z
            pdf = (1 - probability) * wo.z / dr.pi + probability * (self.exponent + 1) * lobe
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

    mi.register_bsdf("interpolated_normals", InterpolatedNormals)
    mi.register_bsdf("phong_lobe", Phong)
