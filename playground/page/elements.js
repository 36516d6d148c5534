// Elements of the page, in few words. All texts are set as texts, never as HTML.
export function element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
        if (key.startsWith("on")) {
            made.addEventListener(key.slice(2), value);
        } else {
            made.setAttribute(key, value);
        }
    }
    made.append(...children.filter((child) => child !== undefined && child !== null));
    return made;
}
