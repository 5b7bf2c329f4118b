// Nothing moves before somebody asks for it; without this script the controls stay hidden.
{
  const figure = document.currentScript.closest("figure");
  const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
  const panels = [...figure.querySelectorAll(".trajgap-arm-panels > div")];
  const controls = figure.querySelector(".trajgap-arm-controls");
  const slider = controls.querySelector("input"), said = controls.querySelector("output");
  const play = controls.querySelector("[data-play]");
  slider.max = data.clock.length - 1;
  controls.hidden = false;
  let timer = null;
  const show = (k) => {
    const now = data.clock[k];
    slider.value = k;
    said.textContent = now.toFixed(2) + " s";
    slider.setAttribute("aria-valuetext", said.textContent);
    panels.forEach((panel, i) => {
      panel.querySelector(".links").setAttribute("points", data.arms[i][k]);
      panel.querySelector(".floor").setAttribute("points", data.floors[i][k]);
      const total = data.totals[i], done = Math.min(now, total);
      panel.querySelector(".now").textContent =
        done.toFixed(2) + " of " + total + " s" + (now >= total ? ", there" : "");
    });
  };
  const stop = () => {
    clearInterval(timer);
    timer = null;
    play.textContent = "Play";
    play.setAttribute("aria-pressed", "false");
  };
  const last = data.clock.length - 1;
  slider.addEventListener("input", () => { stop(); show(+slider.value); });
  controls.querySelectorAll("[data-step]").forEach((button) =>
    button.addEventListener("click", () => {
      stop();
      show(Math.max(0, Math.min(last, +slider.value + +button.dataset.step)));
    }));
  play.addEventListener("click", () => {
    if (timer) return stop();
    if (+slider.value === last) show(0);
    play.textContent = "Stop";
    play.setAttribute("aria-pressed", "true");
    const step = 1000 * data.clock[1];
    timer = setInterval(() => {
      const next = +slider.value + 1;
      if (next > last) return stop();
      show(next);
    }, step);
  });
  show(0);
}
