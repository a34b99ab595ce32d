/** Which charts there are. Colours are those of the vehicle's axes, dashes tell the lines apart without them. */
export const CHARTS = [
  {
    name: "acceleration",
    unit: "m/s²",
    digits: 1,
    leastSpan: 4,
    fromZero: false,
    lines: [
      { of: "longitudinal", colour: "--livella-x", dash: [] },
      { of: "lateral", colour: "--livella-y", dash: [7, 3] },
      { of: "vertical", colour: "--livella-z", dash: [2, 2] },
    ],
  },
  {
    name: "speed",
    unit: "km/h",
    digits: 0,
    leastSpan: 20,
    fromZero: true,
    lines: [{ of: "speed", colour: "--livella-accent", dash: [] }],
  },
  {
    name: "yaw_rate",
    unit: "°/s",
    digits: 1,
    leastSpan: 10,
    fromZero: false,
    lines: [{ of: "yaw_rate", colour: "--livella-accent", dash: [] }],
  },
  {
    name: "sideslip",
    unit: "°",
    digits: 1,
    leastSpan: 4,
    fromZero: false,
    lines: [{ of: "sideslip", colour: "--livella-accent", dash: [] }],
  },
] as const;
