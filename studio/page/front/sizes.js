// SPDX-License-Identifier: BSD-3-Clause
// Sizes of elements, asked once: to ask while a picture is made would lay the page out each time.

const known = new WeakMap();
const watcher = new ResizeObserver((entries) => {
  entries.forEach(({ target }) => known.delete(target));
  window.dispatchEvent(new Event("laid-out"));
});

/** Width and height of an element [pixels]. */
export function sizeOf(element) {
  if (!known.has(element)) {
    const { width, height } = element.getBoundingClientRect();
    known.set(element, { width, height });
    watcher.observe(element);
  }
  return known.get(element);
}
