/** How a device sits in its vehicle. */
export const mounting = {
  straight: "The device sits straight: its axes are the vehicle’s axes.",
  turned: "The device {{how}}.",
  on_end: {
    down: "The device stands on end: its x axis points straight down.",
    up: "The device stands on end: its x axis points straight up.",
    almost_down: "The device stands on end: its x axis points almost straight down.",
    almost_up: "The device stands on end: its x axis points almost straight up.",
  },
  not_unique: "Near a pitch of ±90° yaw and roll are not unique; the picture and the quaternion are.",
  good_to: "Good to {{degrees}}.",
  yaw: {
    left: "is turned {{degrees}} to the left",
    right: "is turned {{degrees}} to the right",
    backward: "faces backward",
    backward_too: "{{turned}} (it faces backward)",
  },
  pitch: {
    down: "has its front tilted {{degrees}} down",
    up: "has its front tilted {{degrees}} up",
  },
  roll: {
    right: "is rolled {{degrees}} onto its right side",
    left: "is rolled {{degrees}} onto its left side",
    over: "lies upside down",
    over_too: "{{rolled}} (upside down)",
  },
  axes: "Its x axis points {{x}}, y axis {{y}} and z axis {{z}}.",
  direction: {
    forward: "forward",
    backward: "backward",
    left: "left",
    right: "right",
    up: "up",
    down: "down",
  },
} as const;
