// Arithmatex leaves \(...\) and \[...\] in elements of its class; KaTeX typesets them.
for (const element of document.querySelectorAll(".arithmatex")) {
    const formula = element.textContent.trim().slice(2, -2);
    katex.render(formula, element, {displayMode: element.tagName === "DIV", throwOnError: false});
}
