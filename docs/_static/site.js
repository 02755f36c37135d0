// What a command prints is broken into lines, but for tables; what scrolls can be scrolled by keys; the two bars beside a
// page have names; an empty cell is no head of a column; and the page of found words has a heading.
document.addEventListener("DOMContentLoaded", () => {
  for (const pre of document.querySelectorAll(".highlight-console pre")) {
    if (!pre.textContent.includes("───")) pre.style.whiteSpace = "pre-wrap";
  }
  for (const part of document.querySelectorAll("pre, .table-wrapper")) part.tabIndex = 0;
  for (const cell of document.querySelectorAll("th")) {
    if (!cell.textContent.trim()) cell.replaceWith(document.createElement("td"));
  }
  document.querySelector("#search-results")?.insertAdjacentHTML("beforebegin", "<h1>Search</h1>");
  document.querySelector(".sidebar-drawer")?.setAttribute("aria-label", "All pages");
  document.querySelector(".toc-drawer")?.setAttribute("aria-label", "On this page");
});
