// The camera of a live frame: it moves as in the window, see common/viewer/camera_control.cpp, whose names these are.
"use strict";

live.Camera = (() => {
    const RADIANS_PER_HEIGHT = 2;                        // per picture height dragged
    const STEEPEST_SINE = 0.999;                         // of elevation: beyond it, left and right would swap
    const HEIGHTS_PER_SECOND = 0.5, LONGEST_STEP = 0.1;  // of the arrow keys; seconds between two pictures
    const DRAG = 4;                                      // pixels by which a drag differs from a click
    const WORDS = 12;                                    // of a Camera in shaders/interface.h before its lens
    // What keys do: steps to the right, up and forward, and turns to the right and up.
    const KEYS = {
        KeyD: [1, 0, 0, 0, 0],
        KeyA: [-1, 0, 0, 0, 0],
        KeyE: [0, 1, 0, 0, 0],
        KeyQ: [0, -1, 0, 0, 0],
        KeyW: [0, 0, 1, 0, 0],
        KeyS: [0, 0, -1, 0, 0],
        ArrowRight: [0, 0, 0, 1, 0],
        ArrowLeft: [0, 0, 0, -1, 0],
        ArrowUp: [0, 0, 0, 0, 1],
        ArrowDown: [0, 0, 0, 0, -1]
    };

    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const scaled = (a, factor) => a.map(x => factor * x);
    const sum = (...vectors) => [0, 1, 2].map(i => vectors.reduce((total, vector) => total + vector[i], 0));
    const length = a => Math.hypot(...a);
    const normalized = a => length(a) > 1e-9 ? scaled(a, 1 / length(a)) : [0, 0, 0];

    // Turns a direction about the upright axis, then up or down, but never past that axis.
    function turn(direction, up, right_angle, up_angle) {
        const upright = scaled(up, dot(direction, up)), cosine = Math.cos(right_angle), sine = Math.sin(right_angle);
        const level = sum(direction, scaled(upright, -1)), heading = sum(scaled(level, cosine), scaled(cross(level, up), sine));
        if (length(level) < 1e-9) return direction;  // straight up: no heading to turn
        const elevation = Math.asin(Math.min(Math.max(dot(direction, up), -1), 1)), limit = Math.asin(STEEPEST_SINE);
        const turned = Math.min(Math.max(elevation + up_angle, Math.min(-limit, elevation)), Math.max(limit, elevation));
        return sum(scaled(normalized(heading), Math.cos(turned)), scaled(up, Math.sin(turned)));
    }

    return class Camera {
        // Of a picture: the words of its parameters, where its scene has the upright axis, and the diagonal of the scene.
        constructor(parameters, {up, scene_size}) {
            this.up = normalized(up);
            this.speed = 0.25 * (scene_size > 0 ? scene_size : 1);  // crosses the scene in four seconds
            this.first = parameters.slice(0, WORDS);
            this.reset();
        }

        reset() {
            const numbers = new Float32Array(Uint32Array.from(this.first).buffer);
            [this.position, this.forward, this.right, this.imageUp] = [0, 3, 6, 9].map(i => [...numbers.subarray(i, i + 3)]);
            this.hasMoved = false;
        }

        // Its words in render parameters.
        get words() {
            const {position, forward, right, imageUp} = this;
            return this.hasMoved ? new Uint32Array(Float32Array.of(...position, ...forward, ...right, ...imageUp).buffer) :
                                   this.first;
        }

        // `steps` to the right, up and forward, in seconds of motion; `drag` of the mouse relative to the picture's height, right
        // and down are positive.
        move({steps = [0, 0, 0], drag = [0, 0]}) {
            const {up} = this, forward = turn(this.forward, up, RADIANS_PER_HEIGHT * drag[0], -RADIANS_PER_HEIGHT * drag[1]);
            const right = normalized(cross(forward, up));
            if (length(right) > 0) {
                this.imageUp = scaled(cross(right, forward), length(this.imageUp));
                this.right = scaled(right, length(this.right));
            }
            const step = sum(scaled(right, steps[0]), scaled(up, steps[1]), scaled(forward, steps[2]));
            Object.assign(this, {forward, position: sum(this.position, scaled(step, this.speed)), hasMoved: true});
        }

        // Moves the camera of `target.camera` by the keys and the pointer over an element. Calls target.moved() after each
        // motion, target.resetCamera() for the key F, and target.clicked(x, y) with a place in the picture, relative to its size.
        static listen(element, target) {
            const pressed = new Set();
            let drag, latest, time;
            const move = motion => {
                target.camera.move(motion);
                target.moved();
            };
            const fly = now => {
                const pull = [...pressed].map(code => KEYS[code]).reduce((a, b) => a.map((x, i) => x + b[i]), [0, 0, 0, 0, 0]);
                const seconds = Math.min((now - time) / 1000, LONGEST_STEP), angle = HEIGHTS_PER_SECOND * seconds;
                time = now;
                if (pull.some(part => part) && seconds > 0)
                    move({steps: pull.slice(0, 3).map(part => part * seconds), drag: [pull[3] * angle, -pull[4] * angle]});
                if (pressed.size) requestAnimationFrame(fly);
            };
            element.addEventListener("keydown", event => {
                const {code, repeat} = event, isFree = !event.ctrlKey && !event.metaKey && !event.altKey;
                if (!target.camera || !isFree || event.target !== element) return;
                if (code !== "KeyF" && !(code in KEYS)) return;
                event.preventDefault();
                event.stopPropagation();  // the theme searches at S and F
                if (code === "KeyF") return repeat || target.resetCamera();
                if (!pressed.size) {
                    time = performance.now();
                    requestAnimationFrame(fly);
                }
                pressed.add(code);
            });
            element.addEventListener("keyup", ({code}) => pressed.delete(code));
            element.addEventListener("blur", () => pressed.clear());
            element.addEventListener("pointerdown", event => {
                if (!target.camera || event.button !== 0 || event.target.matches("input")) return;
                element.setPointerCapture(event.pointerId);
                drag = latest = [event.clientX, event.clientY];
            });
            element.addEventListener("pointermove", event => {
                if (!latest) return;
                const now = [event.clientX, event.clientY], {height} = element.getBoundingClientRect();
                if (drag && Math.hypot(now[0] - drag[0], now[1] - drag[1]) < DRAG) return;
                drag = undefined;  // no click any more
                move({drag: now.map((x, i) => (x - latest[i]) / height)});
                latest = now;
            });
            element.addEventListener("pointerup", ({clientX, clientY}) => {
                const {left, top, width, height} = element.getBoundingClientRect();
                if (drag) target.clicked((clientX - left) / width, (clientY - top) / height);
                drag = latest = undefined;
            });
            element.addEventListener("pointercancel", () => {
                drag = latest = undefined;
            });
        }
    };
})();
