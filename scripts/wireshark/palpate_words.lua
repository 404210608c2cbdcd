-- Names and labels of Palpate's fields where those of palpate_table.lua would not do: names that users filter by, and what
-- a line of the tree says. For palpate_fields.lua: gives a function, so that nothing happens where Wireshark loads this
-- file by itself.

return function()
  -- Lists below that are written by hand. An entry that fits nothing in the table is a mistake, as after a change of
  -- messages.h: `check_used` fails then.
  local lists = {}
  local function by_hand(what, entries)
    local list = {what = what, entries = entries, used = {}}
    table.insert(lists, list)
    return function(key)
      list.used[key] = true
      return entries[key]
    end
  end
  local function check_used()
    for _, list in ipairs(lists) do
      for key in pairs(list.entries) do
        if not list.used[key] then error(("palpate_words.lua: messages.h has no %s %s"):format(list.what, key), 0) end
      end
    end
  end

  -- Names of fields and flags that differ from those of the table: by struct and name there.
  local name_of = by_hand("member", {
    ["Welcome.server"] = "server_nonce",
    ["ToolState.flags"] = "state", ["ToolState.requests_tangent"] = "wants_here",
    ["ToolState.surface_version"] = "asked_version", ["ToolState.pages"] = "asked_page",
    ["ForceSample.number"] = "sample", ["ForceSample.flags"] = "answer", ["ForceSample.has_tangent"] = "here",
    ["ForceSample.surface_v"] = "here.surface_v", ["ForceSample.at_tool"] = "here",
    ["ForceSample.ahead_p"] = "ahead.p", ["ForceSample.ahead_f"] = "ahead.f",
    ["ForceSample.errors.mesh.source"] = "errors.mesh_source", ["ForceSample.errors.mesh.percent"] = "errors.mesh",
    ["ForceSample.errors.time_step.source"] = "errors.time_step_source",
    ["ForceSample.errors.time_step.percent"] = "errors.time_step",
    ["ForceSample.mean_f"] = "mean", ["ForceSample.modal_loads"] = "loads", ["ForceSample.has_modal_loads"] = "loads",
    ["RelaxedState.fraction"] = "share", ["RelaxedState.vertex.number"] = "vertex", ["RelaxedState.vertex.psi"] = "psi",
    ["Telemetry.flags"] = "telemetry", ["Telemetry.age"] = "sample_age", ["Telemetry.rendered_law"] = "felt_law",
    ["Telemetry.name"] = "law", ["Telemetry.error"] = "law_error", ["Telemetry.rendered"] = "felt",
    ["Telemetry.loop.period"] = "period", ["Telemetry.loop.longest_period"] = "longest_period",
    ["Telemetry.loop.ticks"] = "ticks", ["Telemetry.loop.missed"] = "missed",
    ["Telemetry.interventions.faded"] = "faded", ["Telemetry.interventions.clamped"] = "clamped",
    ["Telemetry.interventions.slewed"] = "slewed", ["Telemetry.interventions.damped"] = "damped",
    ["Pointer.number"] = "pointer",
    ["SurfacePage.version"] = "page.version", ["SurfacePage.values"] = "page.value",
  })

  -- Labels, where the name in words would not do. The unit of the table replaces {unit}, or is added.
  local label_of = by_hand("field", {
    attempt = "Attempt (Hellos of this run)", rate = "Rate ({unit}; 0: as fast as it can)",
    newest_sample = "Newest sample used (number; 0: none yet)", t = "t, of the client's clock",
    p = "Tool position p", v = "Tool velocity v", q = "Orientation q", buttons = "Buttons (bits)", state = "Flags",
    ["state.device_lost"] = "Device gave nothing usable", ["state.rearmed"] = "Re-armed at this tick",
    ["state.asks_pages"] = "Asks for pages", ["state.in_pause"] = "Heard of a pause",
    asked_version = "Surface version asked for", asked_page = "Page asked for (number)",
    sample = "Number of the sample", tool_tick = "Tick it answers", tool_t = "t of that tick, of the client's clock",
    f = "Force on the tool f", torque = "Torque on the tool", step = "Time of the server's step", answer = "Flags",
    ["answer.flagged"] = "Flagged: no settled answer", ["answer.wants_telemetry"] = "Asks for Telemetry",
    ["here.surface_v"] = "Surface velocity", ["ahead.p"] = "Place ahead", ["ahead.f"] = "Force there",
    ["here.tangent"] = "Tangent dF/dp", ["ahead.tangent"] = "Tangent dF/dp",
    ["here.normal"] = "Surface normal", ["ahead.normal"] = "Surface normal",
    ["here.gap"] = "Gap between surface and tool", ["ahead.gap"] = "Gap between surface and tool",
    ["surface.version"] = "Version of the surface model", ["surface.shift"] = "Shift from rest",
    ["surface.tool_friction"] = "Tool friction (Coulomb's coefficient)",
    ["errors.mesh_source"] = "Mesh: source of its error",
    ["errors.mesh"] = "Mesh: its error ({unit} of the force's RMS)",
    ["errors.time_step_source"] = "Time step: source of its error",
    ["errors.time_step"] = "Time step: its error ({unit} of the force's RMS)",
    ["others.v"] = "Surface velocity by the other tools", ["others.compliance"] = "Compliance of the other tools",
    ["modes.count"] = "Modes", ["modes.q"] = "Amplitude q", ["modes.v"] = "Rate q'", mean = "Mean force over the step",
    ["relaxed.terms"] = "Terms of the Prony series", ["relaxed.share"] = "Share g of the stress at once",
    ["relaxed.time"] = "Relaxation time tau", ["relaxed.first"] = "First mode told of",
    ["relaxed.count"] = "Modes told of", ["relaxed.z"] = "Late amplitude z", ["relaxed.vertices"] = "Vertices told of",
    ["relaxed.psi"] = "Remembered force psi ({unit}; x, y, z of each term)",
    ["loads.count"] = "Modes that other tools drive", ["loads.load"] = "Load of other tools on a mode",
    cuts = "Steps in which tissue has been removed",
    telemetry = "Flags", ["telemetry.has_motors"] = "The device has motors", ["telemetry.fault"] = "Force latched off",
    ["telemetry.device_lost"] = "Device gives nothing usable", ["telemetry.fading"] = "Newest sample too old",
    dt = "Between two ticks told", sample_age = "Age of the newest sample", period = "Period of the loop, mean",
    longest_period = "Period of the loop, longest", missed = "Ticks missed", passivity_gain = "Gain of passivity",
    faded = "Times that the force was faded", clamped = "Ticks clamped", slewed = "Ticks slewed", damped = "Ticks damped",
    felt_law = "Law that is felt", named = "Column of the law named", law = "Its name",
    law_error = "Its mean error ({unit}; below 0: not known)", laws = "Laws beside it", count = "Ticks told",
    felt = "Force felt", by_law = "Force by a law", pointer = "Number of the pointer",
    ["page.version"] = "Version of the surface model", ["page.value"] = "Value (unit: that of the page)",
  })

  -- Lines of the tree with fields that repeat below them, by the name of the field.
  local branch_of = by_hand("field", {felt = "Force felt", by_law = "Forces by the laws", ["page.value"] = "Values"})

  return {name_of = name_of, label_of = label_of, branch_of = branch_of, check_used = check_used}
end
