/** Before the tests: they read what an Englishman reads, in every room. */
import { openRooms, startText } from ".";

await startText("en");
await openRooms("alerts", "device", "devices", "history", "motion", "mounting", "settings");
