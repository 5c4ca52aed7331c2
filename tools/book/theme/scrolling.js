// Whoever has no mouse scrolls by keys what is wider than the screen, which needs the focus for that. The theme sees to code.
const letScroll = () => {
    for (const element of document.querySelectorAll("article p, article div"))
        if (/auto|scroll/.test(getComputedStyle(element).overflowX))
            element.tabIndex = element.scrollWidth > element.clientWidth ? 0 : -1;
};
for (const event of ["load", "resize"]) addEventListener(event, letScroll);
