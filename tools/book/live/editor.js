// The files of a chapter that a reader may edit: tabs over a text field. The texts stay in the browser's storage.
"use strict";

// An element with attributes and children; attributes that are functions become event handlers.
live.element = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes))
        if (typeof value === "function")
            element.addEventListener(key, value);
        else if (value !== undefined)
            element.setAttribute(key, value);
    element.append(...children);
    return element;
};

live.Editor = (() => {
    const {element} = live, LONGEST = 200_000;  // characters; the longest shader of the course has 4,000
    const MOST_KEPT = 20;                       // texts that were replaced
    const keyOf = path => `path tracing lab: ${path}`;

    // Browsers may forbid storage, and it may be full.
    function store(path, text) {
        try {
            if (text === undefined)
                localStorage.removeItem(keyOf(path));
            else
                localStorage.setItem(keyOf(path), text);
            return true;
        } catch { return false; }
    }
    function stored(path) {
        try {
            return localStorage.getItem(keyOf(path));
        } catch { return null; }
    }

    // The files that a chapter is made of: that of its lesson, its estimator, its others, and what it gets or includes from other
    // chapters.
    function filesOf(chapter) {
        const estimator = `chapters/${chapter}/path_trace.glsl`;
        const files = [...new Set([live.chapters[chapter].exercise?.file ?? estimator, estimator])];
        const add = path => {
            if (path?.startsWith("chapters/") && !files.includes(path)) files.push(path);
        };
        Object.keys(live.sources).filter(path => path.startsWith(`chapters/${chapter}/`)).sort().forEach(add);
        const find = live.glsl.finder(live.sources, chapter);
        for (const path of JSON.parse(live.sources["shaders/replaceable.json"])) add(find(path.replace(/.*\//, ""), path));
        for (const file of files)
            for (const [, name] of live.sources[file].matchAll(/^#include "([^"]*)"/gm)) add(find(name, file));
        return files;
    }

    return class Editor {
        // Calls changed() after each edit, and say(text) for what the reader should know.
        constructor(chapter, changed, say, keepsTexts) {
            Object.assign(this, {chapter, changed, say, keepsTexts, texts: {}, fields: {}, buttons: {}});
            this.files = filesOf(chapter);
            const keydown = event => this.key(event);
            this.tabs = element("div", {role: "tablist", "aria-label": "files of the chapter", class: "live-tabs", keydown});
            this.error = element("div", {class: "live-error", role: "alert"});
            // Each file has a field of its own, and with it what Ctrl+Z undoes.
            for (const file of this.files) {
                this.texts[file] = (keepsTexts ? stored(file) : null) ?? live.sources[file];
                this.fields[file] = element("textarea", {
                    spellcheck: "false",
                    autocapitalize: "off",
                    autocomplete: "off",
                    wrap: "off",
                    rows: "24",
                    "aria-label": `the shader ${file}`,
                    input: () => this.typed(file)
                });
                this.fields[file].value = this.texts[file];
                this.buttons[file] = element("button", {type: "button", role: "tab", title: file, click: () => this.open(file)});
            }
            this.tabs.append(...Object.values(this.buttons));
            this.back = element("button", {type: "button", click: () => this.bringBack()}, "Bring my text back");
            // Texts that were replaced, the latest last.
            this.kept = JSON.parse((keepsTexts ? stored(this.keptName) : null) ?? "[]");
            this.root = element("div", {class: "live-editor"}, this.tabs, ...Object.values(this.fields), this.error);
            this.open(this.fileWithTodo ?? this.files[0]);
            addEventListener("storage", event => {
                if (this.files.some(file => keyOf(file) === event.key))
                    say("Another tab has changed this text: reload the page to see it.");
            });
        }

        key(event) {
            const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
            if (!step) return;
            this.open(this.files.at((this.files.indexOf(this.file) + step) % this.files.length));
            this.buttons[this.file].focus();
        }

        get sources() { return {...live.sources, ...this.texts}; }
        get edited() { return this.files.filter(file => this.texts[file] !== live.sources[file]); }
        get tooLong() { return this.files.find(file => this.texts[file].length > LONGEST); }

        get fileWithTodo() { return this.files.find(file => this.texts[file].includes("TODO")); }

        get field() { return this.fields[this.file]; }
        get keptName() { return `replaced texts of ${this.chapter}`; }
        // The texts that are not the chapter's: {file: text}.
        get state() { return Object.fromEntries(this.edited.map(file => [file, this.texts[file]])); }
        // Whether the reader has written something that the page did not put there.
        get isOwn() { return this.edited.length > 0 && JSON.stringify(this.state) !== this.placed; }

        open(file) {
            this.file = file;
            for (const path of this.files) {
                const button = this.buttons[path], isOpen = path === file;
                this.fields[path].hidden = !isOpen;
                button.setAttribute("aria-selected", String(isOpen));
                button.tabIndex = isOpen ? 0 : -1;
                button.textContent = path.replace(`chapters/${this.chapter}/`, "").replace("chapters/", "") +
                    (this.texts[path] === live.sources[path] ? "" : " *");
            }
            this.back.hidden = !this.kept.length;
        }

        typed(file) {
            const text = this.texts[file] = this.fields[file].value, isEdited = text !== live.sources[file];
            if (this.keepsTexts && !store(file, isEdited ? text : undefined))
                this.say("The browser keeps no text of this page: download it before you leave.");
            this.open(this.file);
            this.changed();
        }

        // Replaces a file's text as if it were typed, so that Ctrl+Z brings the old one back.
        edit(text, file = this.file) {
            const field = this.fields[file], {activeElement} = document;
            this.open(file);
            field.focus({preventScroll: true});
            field.select();
            if (text.length > LONGEST || !document.execCommand(text ? "insertText" : "delete", false, text)) field.value = text;
            field.setSelectionRange(0, 0);
            field.scrollTop = 0;
            activeElement?.focus({preventScroll: true});
            this.typed(file);
        }

        // Puts these texts, {file: text}, and for other files the chapter's own, and shows one. What the reader wrote is kept.
        replace(texts, shown = Object.keys(texts)[0] ?? this.file) {
            if (this.isOwn) this.keep([...this.kept, this.state].slice(-MOST_KEPT));
            for (const file of this.files) {
                const text = texts[file] ?? live.sources[file];
                if (text !== this.texts[file]) this.edit(text, file);
            }
            this.placed = JSON.stringify(this.state);
            this.open(shown);
        }

        keep(kept) {
            this.kept = kept;
            if (this.keepsTexts) store(this.keptName, JSON.stringify(kept));
        }

        // Brings back the text that was replaced last, and the next time the one before. What stands there now comes back last of
        // all.
        bringBack() {
            const {kept, state} = this;
            this.keep([...this.isOwn ? [state] : [], ...kept.slice(0, -1)]);
            this.placed = JSON.stringify(state);
            this.replace(kept.at(-1));
            this.placed = undefined;
        }

        // Shows a message of the form FILE:LINE: TEXT and selects the line, unless the reader is typing elsewhere.
        showError(message) {
            this.error.replaceChildren();
            if (!message) return;
            const [, file, line] = /^(\S+):(\d+): /.exec(message) ?? [], click = () => this.select(file, Number(line));
            this.error.append(message);
            if (this.files.includes(file)) this.error.append(" ", element("button", {type: "button", click}, "Go to the line"));
        }

        select(file, line) {
            if (this.file !== file) this.open(file);
            const lines = this.field.value.split("\n");
            const start = lines.slice(0, line - 1).reduce((sum, l) => sum + l.length + 1, 0);
            this.field.focus();
            this.field.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
            this.field.scrollTop = this.field.scrollHeight * Math.max(0, line - 6) / lines.length;
        }

        // Goes to what an exercise leaves to the reader.
        selectTodo() {
            const file = this.fileWithTodo;
            if (file) this.select(file, this.texts[file].split("TODO")[0].split("\n").length);
            this.field.scrollIntoView({block: "nearest"});
        }

        download() {
            const url = URL.createObjectURL(new Blob([this.texts[this.file]], {type: "text/plain"}));
            element("a", {href: url, download: this.file.replace(/.*\//, "")}).click();
            setTimeout(() => URL.revokeObjectURL(url), 1000);
        }

        openFile() {
            element("input", {
                type: "file",
                accept: ".glsl,.txt",
                change: async event => {
                    const [file] = event.target.files;
                    if (!file) return;
                    const bytes = new Uint8Array(await file.arrayBuffer());
                    let text;
                    // As project.py reads them: an editor may have saved the encoding of Windows.
                    try {
                        text = new TextDecoder("utf-8", {fatal: true}).decode(bytes);
                    } catch { text = new TextDecoder("windows-1252").decode(bytes); }
                    const place = this.files.find(path => path.endsWith(`/${file.name}`)) ?? this.file;
                    this.replace({...this.state, [place]: text.replace(/\r\n?/g, "\n")}, place);
                }
            }).click();
        }

        // The address of this page with the edited texts in its fragment, which browsers send to nobody.
        async link() {
            const packed = new Blob([JSON.stringify(this.state)]).stream().pipeThrough(new CompressionStream("gzip"));
            const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
            const text = btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join(""));
            const code = text.replaceAll("+", "-").replaceAll("/", "_");
            return `${location.href.split("#")[0]}#live=${code}`;
        }

        // Reads a text from the page's address, which it leaves there no longer: later work would be lost to it.
        async readLink() {
            const code = this.keepsTexts ? /^#live=([\w=-]+)$/.exec(location.hash)?.[1] : null;
            if (!code) return;
            history.replaceState(null, "", location.href.split("#")[0]);
            try {
                const bytes = await live.loading.unpack(code.replaceAll("-", "+").replaceAll("_", "/"));
                const texts = Object.entries(JSON.parse(new TextDecoder().decode(bytes))), hasOwn = this.isOwn;
                const isKnown = ([file, text]) => this.files.includes(file) && typeof text === "string";
                this.replace(Object.fromEntries(texts.filter(isKnown)));
                this.say(`This text comes from a link.${hasOwn ? " “Bring my text back” has yours." : ""}`);
            } catch { this.say("The link is damaged: here is your own text, or the chapter's."); }
        }
    };
})();
