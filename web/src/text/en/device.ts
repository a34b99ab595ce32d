/** One device: what to do now, how sure the result is, how it is mounted. */
export const device = {
  the_device: "the device",
  gone: "The device {{id}} does not exist",

  action: {
    motion: "Motion",
    print: "Print the certificate",
    refit: "Device refitted",
    more: "More",
    edit: "Edit name, vehicle and notes",
    new_key: "New device key",
    remove: "Remove the device",
  },

  live: {
    region: "Calibration now",
    stages: "Stages",
    step: { done: " (done)", current: " (now)", ahead: " (not yet)" },
    status: "Stage: {{stage}}. {{say}}",
    also: "Also needed",
  },

  now: {
    silent: "Switch on and drive on: the calibration goes on with the next data.",
    data: "Waiting for data: switch the device on and check that it can send.",
    data_again: "Drive on: the calibration begins with the next data.",
    gps_fix: "Drive, or park, under open sky until there is a GPS fix.",
    motion: "Drive off: the vehicle has to move.",
    turn: "Take a few turns to the left and to the right.",
    accelerate_or_brake: "Brake firmly once or twice on a straight road.",
    time: "Keep driving as usual.",
    verifying: "Keep driving as usual: the result is being tested.",
    confirmed: "The mounting is confirmed. Nothing needs to be done.",
  },

  figure: {
    list: "What the device sends",
    gps: "GPS fix",
    speed: "Speed",
    rate: "Samples",
    gyroscope: "Gyroscope",
    last: "Last data",
    seconds_ago: "{{seconds}} s ago",
    as_of: "as of {{time}}",
  },

  trouble: {
    list: "What is wrong",
    silent: "The device is silent: last data {{ago}}",
    silent_do:
      "Switch the ignition on. If nothing comes, check the power, the SIM card and the key of the device.",
    no_fix: "The receiver has no GPS fix",
    no_fix_do: "Drive into the open and wait two minutes. If none comes, check the antenna and its cable.",
    sample_rate: "Only {{rate}} samples a second",
    sample_rate_do: "Set the device to {{least}} samples a second at least; 50 to 100 are good.",
    fix_rate: "Only {{rate}} GPS fixes a second",
    fix_rate_do: "Set the receiver to one fix a second at least; 5 to 10 shorten the calibration.",
    rejected: "{{share}} of the readings are not used",
    duplicate_time:
      "Samples carry the same time twice. Check the clock of the device and how it numbers its samples.",
    before_previous_sample:
      "Samples come in the wrong order. Check that the device sends them in the order of their times.",
    fix_without_velocity:
      "GPS fixes come without speed and course. Let the device send both, or its position more often.",
    fix_implausible:
      "GPS fixes jump, as they do between high walls or under a roof. Drive into the open; check where the antenna sits.",
    other_reason: "The service gives as the reason: {{reason}}.",
    failed: "The drive test failed",
    failed_do: "Keep driving. The result goes on improving, and the test is made again by itself.",
    suspect: "The device seems to have moved",
    suspect_do:
      "The mounting confirmed on {{time}} is kept but no longer trusted. Check that the device is firmly fastened, then drive on: a new mounting is confirmed in the same way.",
    stalled: "This takes longer than usual",
    stalled_do:
      "Brake firmly and take some corners. If that does not help, check that the device is firmly fastened and that its antenna sees the sky.",
  },

  level: {
    offer: "Vehicle stands on level ground",
    ask: "Does the vehicle stand on level ground?",
    about:
      "On level ground gravity shows at once how the device is tilted. Which way it faces still needs braking or a turn. Say so only while the vehicle stands still on a level floor, with nobody getting in or out.",
    yes: "It stands level",
    taken: "Level ground was taken into account",
    taken_next: "Drive off now, brake and take a turn.",
    refused: "This was not taken",
  },

  sure: {
    title: "How sure",
    below: "below the limit",
    about_x: "about the forward axis",
    about_y: "about the left axis",
    about_z: "about the vertical axis",
    plus_minus: "± {{degrees}}",
    note: "One standard deviation. The marks are what the drive test needs.",
    chart: "Uncertainty over time",
    chart_says: "Uncertainty over time; last: roll {{roll}}, pitch {{pitch}}, yaw {{yaw}}",
    limit: "limit",
    the_chart: "the chart",
    empty: "Nothing is known yet",
    empty_do:
      "As soon as the vehicle drives, three curves appear here and sink. Below the limit the drive test begins by itself.",
  },

  test: {
    title: "Drive test",
    passed: "Passed",
    failed: "Failed",
    running: "Running",
    none: "No test is running.",
    begins: "Starts by itself once the angles have settled, and takes {{seconds}} s of driving.",
    how: "The speed that follows from the sensor is compared with the speed of the GPS.",
    left_word: "left",
    left_says: "{{seconds}} s of driving left",
    goes_on: "It goes on until the result is sure enough, for {{seconds}} s more at most.",
    error: "Speed error {{error}} km/h, at most {{limit}} km/h",
    within: "within the limit",
    beyond: "beyond the limit",
    failed_why: "The speeds were too far apart. Keep driving: the test is made again by itself.",
    gps: "GPS",
    sensor: "Sensor",
    the_chart: "the chart of the speeds",
    axis: "Speed in km/h",
    chart_says:
      "Speed over {{seconds}} s of driving: GPS from {{gps_first}} to {{gps_last}} km/h, sensor from {{sensor_first}} to {{sensor_last}} km/h; farthest apart by {{gap}} km/h",
  },

  mounting: {
    title: "Mounting",
    empty: "Not known yet",
    empty_do: "Drive a little; it shows by itself.",
    so_far: "So far, not confirmed",
    suspect: "Suspect",
    confirmed: "Confirmed <time />",
  },

  picture: {
    about: "Picture of the vehicle; the arrow keys turn it",
    views: "View of the vehicle",
    corner: "Corner",
    above: "Above",
    left: "Left",
    behind: "Behind",
    from_above: "From above",
    from_left: "From the left",
    from_behind: "From behind",
    forward: "forward",
    leftward: "left",
  },

  numbers: {
    title: "Numbers",
    quaternion: "Quaternion q_vs: w, x, y, z",
    note: "Turns sensor readings into vehicle readings, f_v = R(q_vs) f_s. Vehicle axes: x forward, y left, z up (ISO 8855).",
    matrix: "Matrix R(q_vs)",
    of_device: "device {{axis}}",
    forward: "forward",
    left: "left",
    up: "up",
  },

  certificate: {
    title: "Installation certificate",
    device: "Device",
    vehicle: "Vehicle",
    stage: "Stage",
    confirmed: "Confirmed",
    not_yet: "not yet",
    last_data: "Last data",
    notes: "Notes",
    printed: "Printed",
    suspect: "Suspect: the device seems to have moved",
    mounting: "Mounting",
    mounting_so_far: "Mounting so far, not confirmed",
    nothing: "No mounting is known yet.",
    angles: "Angles in degrees (ISO 8855), with one standard deviation",
    quaternion: "Quaternion q_vs (w, x, y, z): {{quaternion}}",
    test: "Drive test",
    test_passed:
      "Passed: after {{seconds}} s of driving the speed from the sensor was {{error}} km/h off the GPS, where {{limit}} km/h are allowed.",
    no_test: "No drive test belongs to this mounting yet.",
    page: "This device’s page",
    installer: "Installed by",
    signature: "Date and signature",
  },

  refit: {
    ask: "Was the device fitted anew?",
    begins: "The mounting in force ends, and the calibration begins with the next drive.",
    stays: "What stays: earlier mountings, the history of the angles, and the alerts.",
    go: "Start again",
    failed: "The calibration was not started again",
  },

  edit: {
    title: "Edit the device",
    name: "Name",
    vehicle: "Vehicle",
    vehicle_example: "Make, model, plate",
    notes: "Notes",
    save: "Save",
    failed: "The changes were not saved",
  },

  key: {
    ask: "Make a new device key?",
    about:
      "The key that the device has now stops working at once. Until the new one is in the device, nothing that it sends is taken.",
    go: "Make a new key",
    failed: "No new key was made",
    made: "The new key",
    once: "This key is shown only now",
    once_do: "Put it into the device, or keep it safe.",
    label: "Key of {{name}}",
    code: "QR code of the key",
  },

  removal: {
    title: "Remove the device?",
    about: "Its key, its mountings, its history and its alerts are deleted. This cannot be undone.",
    type: "Type {{name}} to confirm",
    go: "Remove for ever",
    failed: "The device was not removed",
  },
} as const;
