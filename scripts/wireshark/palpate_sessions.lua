-- What follows from the datagrams before: whether a tag is good, what a sequence number says, and how old a force is. For
-- palpate.lua: gives a function of what palpate_fields.lua gives, and of the hash.

return function(P, blake2b)
  local TYPE = P.types
  local STALE = 300  -- ms of age at which a client begins to fade a force

  -- Keys and tags -------------------------------------------------------------------------------------------------------

  local keys = {}       -- by number: 32 bytes
  local key_file_fault  -- why there are none, although a file was named

  local function bytes_of_hex(text)
    return (text:gsub("%x%x", function(pair) return string.char(tonumber(pair, 16)) end))
  end

  local function read_key_file(path)
    keys, key_file_fault = {}, nil
    if path == "" then return end
    local file, why = io.open(path)
    if not file then
      key_file_fault = why
      return
    end
    local number_of_line = 0
    for line in file:lines() do
      number_of_line = number_of_line + 1
      local words = line:gsub("#.*", "")
      local number, hex = words:match("^%s*palpate%-key%s+(%d+)%s+(%x+)%s*$")
      if number and #hex == 64 and tonumber(number) >= 1 and tonumber(number) <= 255 then
        keys[tonumber(number)] = bytes_of_hex(hex)
      elseif words:match("%S") then
        key_file_fault = ("%s:%d: not \"palpate-key NUMBER 64-HEX-DIGITS\", with a number from 1 to 255"):format(
          path, number_of_line)
      end
    end
    file:close()
  end

  -- The key of one direction of one session. Kept, as every datagram of the session needs it.
  local direction_keys = {}
  local function direction_key(shared, from, client_nonce, server_nonce)
    local label = from == "client" and "client to server" or "server to client"
    local text = label .. ("\0"):rep(24 - #label) .. string.char(P.version) .. client_nonce .. server_nonce
    local known = direction_keys[shared .. text] or blake2b(text, 32, shared)
    direction_keys[shared .. text] = known
    return known
  end

  local BEFORE_SESSION = {[TYPE.Hello] = true, [TYPE.Challenge] = true, [TYPE.Welcome] = true, [TYPE.Refuse] = true}

  -- The verdict on a tag, in words. `all` is the datagram without its tag; `session` is what is known of it, or nil.
  local function judge_tag(d, all, tag, session)
    if key_file_fault then return ("cannot be checked (%s)"):format(key_file_fault) end
    if not next(keys) then return "not checked (no key file is named)" end
    if not keys[d.key] then return ("cannot be checked (key %d is not in the key file)"):format(d.key) end
    local client_nonce, server_nonce = d.values.nonce, P.no_nonce
    if not BEFORE_SESSION[d.type] then
      if not (session and session.server_nonce) then
        return "cannot be checked (the Welcome is not in the capture)"
      end
      client_nonce, server_nonce = session.client_nonce, session.server_nonce
    end
    local key = direction_key(keys[d.key], d.from, client_nonce, server_nonce)
    return blake2b(all, P.tag, key) == tag and "good" or "bad"
  end

  -- What is remembered of each session ----------------------------------------------------------------------------------

  local sessions = {}  -- by number, as text

  -- Which sequence numbers of one sender were seen: the rules of protocol/replay_window.h.
  local Window = {}
  Window.__index = Window
  local WINDOW, NEAR, ENOUGH = 64, 64, 4

  local function new_window(farthest)
    return setmetatable({farthest = farthest, seen = {}, in_a_row = 0, last_wild = 0}, Window)
  end

  -- A number far ahead is wild, but for the fourth in a row, each a little beyond the one before.
  function Window:is_new_beginning(n)
    local goes_on = self.in_a_row > 0 and n > self.last_wild and n - self.last_wild <= NEAR
    self.in_a_row = goes_on and self.in_a_row + 1 or 1
    self.last_wild = n
    if self.in_a_row < ENOUGH then return false end
    self.in_a_row = 0
    return true
  end

  -- Takes a number. Gives whether it is new, and what is to be said of it: kind and text. As a capture may begin anywhere,
  -- the first number of all is taken whatever it is; as it may lack what the receiver got, one that is wild is new, too.
  function Window:take(n)
    local highest = self.highest or n - 1
    if n <= highest then
      if self.seen[n] then return false, "duplicate", ("sequence %.0f was seen before"):format(n) end
      if highest - n >= WINDOW then
        return false, "old", ("sequence %.0f is %.0f behind the highest"):format(n, highest - n)
      end
      self.seen[n] = true
      return true, "overtaken", ("sequence %.0f was overtaken by %.0f"):format(n, highest)
    end
    local ahead = n - highest
    if ahead > self.farthest and not self:is_new_beginning(n) then
      local text = "sequence %.0f is %.0f ahead of the highest; a receiver that saw no more drops it"
      return true, "wild", text:format(n, ahead)
    end
    self.in_a_row, self.highest, self.seen[n] = 0, n, true
    if ahead > 1 then return true, "lost", ("missing before this one: %.0f"):format(ahead - 1) end
    return true
  end

  local function session_of(id)
    sessions[id] = sessions[id] or {
      ticks = {}, tool_ts = {}, surfaces = {},
      windows = {client = new_window(100), server = new_window(24)},  -- as far ahead as their receivers take
    }
    return sessions[id]
  end

  -- Of two times, a - b in seconds, ms to the microsecond.
  local function ms_between(a, b) return math.floor((a - b) * 1e6 + 0.5) / 1e3 end

  local follow = {}  -- by type: what an accepted datagram tells of its session, and what the session tells of it

  -- A Welcome whose tag is good is not replaced by one whose tag is not.
  follow[TYPE.Welcome] = function(d, session, result)
    if session.is_proven and result.tag_verdict ~= "good" then return end
    session.client_nonce, session.server_nonce = d.values.nonce, d.values.server
    session.client, session.is_proven = d.destination, result.tag_verdict == "good"
  end

  follow[TYPE.ToolState] = function(d, session, result)
    session.client = session.client or d.source
    session.ticks[tostring(d.values.tick)] = {time = d.time, frame = d.frame}
    local used = session.tool_ts[tostring(d.values.newest_sample)]
    if used then result.age = ms_between((d.values.t - used):tonumber() / 1e9, 0) end
  end

  follow[TYPE.ForceSample] = function(d, session, result)
    local v = d.values
    local asked = session.ticks[tostring(v.tool_tick)]
    if asked then
      result.round_trip, result.answers = ms_between(d.time, asked.time), asked.frame
      result.age = result.round_trip
    end
    if session.last_sample then result.gap = ms_between(d.time, session.last_sample) end
    session.last_sample = d.time
    session.tool_ts[tostring(v.number)] = v.tool_t
    if v["force_sample.flags_set"].has_surface then
      session.surfaces[v["surface.version"]] = {
        vertices = v["surface.vertices"], triangles = v["surface.triangles"], modes = v["modes.count"] or 0}
    end
  end

  local PER_PAGE, CLUSTER, MODES_PER_PAGE = 75, 5, 15

  -- What a page holds: the rules of protocol/surface_pages.h.
  local function kind_of_page(page, of)
    local function pages(count, each) return math.ceil(count / each) end
    local positions, triangles = pages(of.vertices, PER_PAGE), pages(of.triangles, PER_PAGE)
    local clusters, mode_groups = pages(of.vertices, CLUSTER), pages(of.modes, MODES_PER_PAGE)
    local tiles = clusters * (clusters + 1) / 2
    if page < positions then return ("positions of vertices from %d, m"):format(page * PER_PAGE) end
    page = page - positions
    if page < triangles then return ("triangles from %d, vertex numbers"):format(page * PER_PAGE) end
    page = page - triangles
    if page < tiles then
      local a = math.floor((math.sqrt(8 * page + 1) - 1) / 2)
      return ("compliance between clusters %d and %d, m/N"):format(a, page - a * (a + 1) / 2)
    end
    page = page - tiles
    if mode_groups > 0 and page == 0 then return "spectrum of the modes, rad/s and 1/s" end
    if mode_groups == 0 or page > clusters * mode_groups then return "beyond the last page" end
    return ("shapes of modes from %d at cluster %d, 1/sqrt(kg)"):format(
      (page - 1) % mode_groups * MODES_PER_PAGE, math.floor((page - 1) / mode_groups))
  end

  follow[TYPE.SurfacePage] = function(d, session, result)
    local surface = session.surfaces[d.values["surface_page.version"]]
    if surface then result.page_kind = kind_of_page(d.values.page, surface) end
  end

  -- Whether datagrams of a type have a sequence number of their session.
  local function is_counted(type_of_message)
    return type_of_message == TYPE.Welcome or not BEFORE_SESSION[type_of_message]
  end

  -- The first pass over a datagram that its receiver would read: the verdict on its tag, on its sequence number, and what
  -- follows from those before it.
  local function examine(d, all, tag)
    local result = {experts = {}}
    local function say(kind, text) table.insert(result.experts, {kind, text}) end
    if not d.is_whole then return result end
    if tag then
      result.tag_verdict = judge_tag(d, all, tag, sessions[d.session])
      if result.tag_verdict == "bad" then
        say("bad_tag", "the tag is not that of these bytes under the session's key")
        return result
      end
    elseif next(keys) then
      say("no_tag", "no tag, though the key file holds a key")
      local session = sessions[d.session]
      if session and session.is_proven then return result end
    end
    if not is_counted(d.type) or #d.faults > 0 then return result end
    local session = session_of(d.session)
    local is_new, kind, text = session.windows[d.from]:take(d.sequence)
    if kind then say(kind, text) end
    if is_new and follow[d.type] then follow[d.type](d, session, result) end
    if result.age and result.age > STALE then say("stale", ("the force is %.3f ms old"):format(result.age)) end
    return result
  end

  -- Forgets all that was read, and reads the keys anew.
  local function begin(key_file)
    sessions, direction_keys = {}, {}
    read_key_file(key_file)
  end

  -- The address of a session's client, if that is known.
  local function client_of(id) return sessions[id] and sessions[id].client end

  return {begin = begin, examine = examine, client_of = client_of}
end
