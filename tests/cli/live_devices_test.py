"""The book's live frames where a device cannot do everything, takes long, or goes away, and what they do while nobody looks."""

import time
import unittest

from live_pages_test import BLACK, LivePages

# A device that writes at most so many textures of 128 bits at once.
WRITES_AT_MOST = """(() => {
    const most = %d, { prototype } = WebGL2RenderingContext, attach = prototype.framebufferTexture2D, bind = prototype.bindFramebuffer, { drawArrays } = prototype;
    const attached = new Map();
    let bound = null;
    prototype.bindFramebuffer = function(target, frame) { bound = frame; return bind.call(this, target, frame); };
    prototype.framebufferTexture2D = function(...all) { attached.set(bound, (attached.get(bound) ?? 0) + 1); return attach.apply(this, all); };
    prototype.checkFramebufferStatus = function() { return attached.get(bound) > most ? this.FRAMEBUFFER_UNSUPPORTED : this.FRAMEBUFFER_COMPLETE; };
    prototype.drawArrays = function(...all) { if (!(attached.get(bound) > most)) drawArrays.apply(this, all); };
})()"""


class LiveDevicesTest(LivePages, unittest.TestCase):
    def test_without_webgl(self):
        self.start(3, before="HTMLCanvasElement.prototype.getContext = () => null")
        self.wait("frame.verdict?.textContent.includes('no WebGL 2')", "the message")
        for name in ("Restart", "Check"):
            self.click(name)
        self.assert_no_complaints()

    def test_a_device_that_draws_nothing(self):
        self.start(3, before="WebGL2RenderingContext.prototype.drawArrays = () => {}")
        self.wait("frame.verdict?.textContent.includes('nothing is drawn')", "the message")

    def test_a_shader_without_rays_has_no_verdict(self):
        self.start(3)
        self.edit(BLACK, "vec3 radiance = vec3(0.5); if (radiance.r > 0.0) return radiance;")
        self.wait("frame.film?.samples >= 32 && frame.editor.edited.length", "a picture")
        self.assertEqual(self.frame("frame.verdict.textContent"), "no verdict: the shader traces no ray")
        self.frame("void frame.check()")
        self.wait("frame.verdict.textContent.includes('nothing to check')", "the message")

    def test_a_pause(self):
        self.start(3)
        self.wait("frame.film", "a picture")
        self.click("Pause")
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        self.assertIn("press Go on", self.frame("frame.note.textContent"))
        self.wait("frame.picture.numbers.textContent.startsWith('paused')", "a paused picture")
        self.click("Go on")
        self.wait("frame.film", "a picture")
        self.edit("vec3(0.5);", "vec3(0.5)")
        self.error()
        self.assertEqual(self.frame("frame.picture.numbers.textContent"), "")

    def test_a_frame_out_of_view_pauses(self):
        self.start(3)
        self.wait("frame.film", "a picture")
        self.frame("(frame.root.style.marginTop = '5000px', scrollTo(0, 0))")
        self.wait("!frame.isVisible", "the frame to be out of view")
        samples = self.frame("frame.picture.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertLessEqual(self.frame("frame.picture.renderings[0].rendering.samples"), 2 * samples)
        samples = self.frame("frame.picture.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertEqual(self.frame("frame.picture.renderings[0].rendering.samples"), samples)
        self.frame("frame.root.scrollIntoView()")
        self.wait(f"frame.picture.renderings[0].rendering.samples > {samples}", "more samples")

    def test_a_hidden_tab_pauses(self):
        self.start(3, before="Object.defineProperty(document, 'hidden', { get: () => window.isHidden, configurable: true })")
        self.wait("frame.film", "a picture")
        self.browser.evaluate("window.isHidden = true")
        time.sleep(1)
        samples = self.frame("frame.picture.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertEqual(self.frame("frame.picture.renderings[0].rendering.samples"), samples)
        self.browser.evaluate("window.isHidden = false")
        self.wait(f"frame.picture.renderings[0].rendering.samples > {samples}", "more samples")


class LiveDevices_all(LivePages, unittest.TestCase):
    def lose(self, losses=0, restores=True):
        """Takes the GPU away, as if that had happened so many times without a picture between."""
        self.frame(
            f"(frame.picture.losses = {losses}, (window.loss ??= frame.picture.renderer.gl.getExtension('WEBGL_lose_context')).loseContext())"
        )
        self.wait("frame.picture.renderer.gl.isContextLost() && !frame.picture.renderings.length", "the loss")
        self.frame("(frame.film = null, 0)")
        if restores:
            self.frame("window.loss.restoreContext()")

    def test_a_lost_context_starts_again(self):
        self.start(3)
        for _ in range(3):
            self.wait("frame.film?.samples >= 16", "a picture")
            self.lose()
        self.wait("frame.film", "a new picture")
        self.lose(losses=1)
        self.wait("frame.verdict.textContent.includes('away again before')", "the message")
        self.click("Restart")
        self.wait("frame.film?.samples >= 16", "a picture")
        self.lose(restores=False)
        self.click("Restart")
        self.wait("frame.verdict.textContent.includes('has taken the GPU away: reload')", "the message")

    def test_devices_that_write_less_at_once(self):
        for most in (2, 1):
            self.start(3, before=WRITES_AT_MOST % most)
            self.wait("frame.latest?.verdict", "a verdict")
            self.assertRegex(self.frame("frame.latest.text"), "^agrees")
            self.assertGreater(self.frame("frame.film.rays"), 0)
            self.assert_no_complaints()
        self.start(3, before=WRITES_AT_MOST % 0)
        self.wait("frame.verdict?.textContent.includes('cannot store the sums')", "the message")

    def test_a_long_loop(self):
        self.start(3)
        self.edit(BLACK, BLACK + " for (int i = 0; i < 20000; ++i) radiance.r += 1e-20;")
        self.wait("frame.film && frame.editor.edited.length", "a picture")
        self.assertEqual(self.frame("frame.editor.error.textContent"), "")

    def test_a_loop_that_does_not_end(self):
        """Nor does the next one in the same page, once the reader has mended the first."""
        right = "vec3 throughput = vec3(1.0);"
        self.start(3)
        for loop in (
            "while (true) { radiance.r += 0.0; }",
            "for (;;) radiance.r += 0.0;",
            "do { radiance.r += 0.0; } while (true);",
            "if (seed.x % 4096u == 0u) while (true) { radiance.r += 0.0; }",
        ):
            self.edit(right, f"{right} {loop}")
            self.assertRegex(self.error(), r"path_trace\.glsl:\d+: this loop does not end")
            self.assertFalse(self.frame("frame.picture.renderer.gl.isContextLost()"))
            self.edit(f"{right} {loop}", right)
            self.wait("!frame.editor.error.textContent && frame.film", "the picture")
