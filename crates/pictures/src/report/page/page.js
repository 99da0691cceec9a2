// The page: a switch between light and dark, and all its figures.

const dark = matchMedia("(prefers-color-scheme: dark)");

function addSchemeSwitch() {
  const root = document.documentElement;
  const isDark = () => (root.dataset.scheme ?? (dark.matches ? "dark" : "light")) === "dark";
  const button = element("button", { type: "button", class: "scheme" });
  const name = () => (button.textContent = isDark() ? "Light colours" : "Dark colours");
  button.addEventListener("click", () => {
    root.dataset.scheme = isDark() ? "light" : "dark";
    name();
  });
  dark.addEventListener("change", name);
  name();
  document.querySelector("header").prepend(button);
}

addSchemeSwitch();
for (const figure of document.querySelectorAll("figure")) new ChartFigure(figure);
