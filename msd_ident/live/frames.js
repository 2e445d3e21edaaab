// Runs in the page once it is there. Asks for a frame when the last one was painted and the page is looked at, so a slow
// browser gets fewer of them, a hidden one none, and nothing piles up.
const period = 1000 / pulse.rate
// Without an answer for so long [ms], the page says so; and comes back by itself when the server is there, but was restarted.
const patience = 4000
const despair = 12000
let asked = performance.now()
let answered = true
let due = false

const dark = window.matchMedia("(prefers-color-scheme: dark)")
pulse.dark = dark.matches
dark.addEventListener("change", () => { pulse.dark = dark.matches })

const lay = (frame) => {
  const [start, end] = frame.time
  const {buffer, byteOffset} = frame.points
  let place = byteOffset
  const take = (size) => {
    const part = new Float32Array(buffer, place, size)
    place += part.byteLength
    return part
  }
  for (const [name, size] of Object.entries(frame.sizes)) {
    const t = Float64Array.from(take(size), (since) => start + since)
    sources[name].data = {t, y: take(size)}
  }
  const known = Number.isFinite(frame.noise)
  sources.noise.data = known
    ? {t: [start - 1e6, end + 1e6], low: [-frame.noise, -frame.noise], high: [frame.noise, frame.noise]}
    : {t: [], low: [], high: []}
  time.setv({start, end})
  for (const [name, [low, high]] of Object.entries(frame.ranges)) ranges[name].setv({start: low, end: high})
  for (const [name, text] of Object.entries(frame.texts)) {
    const place = document.getElementById(name)
    if (place !== null && place.textContent !== text) place.textContent = text
  }
}

const ask = () => {
  due = false
  if (!answered || pulse.paused) return
  asked = performance.now()
  answered = false
  pulse.asked += 1
}

// A hidden page is given no animation frame, so it asks again when it is looked at.
const next = () => {
  if (due || !answered || pulse.paused) return
  due = true
  setTimeout(() => requestAnimationFrame(ask), Math.max(period - (performance.now() - asked) - 8, 0))
}

pulse.properties.frame.change.connect(() => {
  answered = true
  document.body.classList.remove("lost")
  lay(Object.fromEntries(pulse.frame instanceof Map ? pulse.frame : Object.entries(pulse.frame)))
  document.body.dataset.frames = String(Number(document.body.dataset.frames ?? 0) + 1)
  next()
})

pulse.properties.paused.change.connect(() => {
  for (const tool of tools) tool.active = pulse.paused
  document.body.classList.toggle("paused", pulse.paused)
  next()
})

const reload = () => {
  fetch(location.pathname, {cache: "no-store"}).then(() => location.reload(), () => {})
}

next()

setInterval(() => {
  if (answered || performance.now() - asked < patience || document.hidden) return
  document.body.classList.add("lost")
  if (performance.now() - asked > despair) reload()
}, 2000)
