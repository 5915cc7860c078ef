--- Scenic's language server in Neovim, from version 0.7 on.
local M = {}

--- What can be set with `require("scenic").setup { ... }`.
M.config = {
  --- How the server is started.
  cmd = { "scenic", "lsp" },
  --- Whether `:ScenicShow`, `:ScenicSample` and `:ScenicSimulate` may run programs; the server asks if this is nil.
  trusted = nil,
  --- Called with client and buffer when the server serves a buffer: the place for mappings.
  on_attach = nil,
  --- What the client can do, from plugins for completion for example.
  capabilities = nil,
}

--- Servers by the folder that they serve.
local clients = {}

function M.setup(options)
  M.config = vim.tbl_extend("force", M.config, options or {})
end

local function folder_of(buffer)
  local file = vim.api.nvim_buf_get_name(buffer)
  local beside = vim.fn.fnamemodify(file ~= "" and file or vim.fn.getcwd() .. "/x", ":p:h")
  local settings = vim.fn.findfile("pyproject.toml", vim.fn.fnameescape(beside) .. ";")
  if settings ~= "" then
    return vim.fn.fnamemodify(settings, ":p:h")
  end
  local repository = vim.fn.finddir(".git", vim.fn.fnameescape(beside) .. ";")
  return repository ~= "" and vim.fn.fnamemodify(repository, ":p:h:h") or beside
end

--- Start a server for a buffer, or have the one of its folder serve it; returns the client's number.
function M.start(buffer)
  local folder = folder_of(buffer)
  local config = {
    name = "scenic",
    cmd = M.config.cmd,
    root_dir = folder,
    workspace_folders = { { uri = vim.uri_from_fname(folder), name = vim.fn.fnamemodify(folder, ":t") } },
    capabilities = M.config.capabilities or vim.lsp.protocol.make_client_capabilities(),
    init_options = { trusted = M.config.trusted },
    on_attach = function(client, served)
      vim.api.nvim_buf_set_option(served, "omnifunc", "v:lua.vim.lsp.omnifunc")
      if M.config.on_attach then
        M.config.on_attach(client, served)
      end
    end,
    on_exit = function()
      clients[folder] = nil
    end,
  }
  if clients[folder] == nil then
    if vim.fn.executable(config.cmd[1]) == 0 then
      vim.notify(
        ("scenic: %q is not there; install the package scenic-lang, or set `cmd`"):format(config.cmd[1]),
        vim.log.levels.WARN
      )
      return nil
    end
    clients[folder] = vim.lsp.start_client(config)
  end
  if clients[folder] ~= nil then
    vim.lsp.buf_attach_client(buffer, clients[folder])
  end
  return clients[folder]
end

--- Stop all servers, and start those again that serve a loaded buffer.
function M.restart()
  for folder, client in pairs(clients) do
    vim.lsp.stop_client(client, true)
    clients[folder] = nil
  end
  for _, buffer in ipairs(vim.api.nvim_list_bufs()) do
    if vim.api.nvim_buf_is_loaded(buffer) and vim.bo[buffer].filetype == "scenic" then
      M.start(buffer)
    end
  end
end

local function open(path)
  if vim.ui.open then
    vim.ui.open(path)
  else
    local opener = vim.fn.has("mac") == 1 and "open" or vim.fn.has("win32") == 1 and "explorer" or "xdg-open"
    vim.fn.jobstart({ opener, path }, { detach = true })
  end
end

--- Have the server run a command that answers with a page, and show that.
local function run(buffer, command, arguments, show)
  vim.lsp.buf_request(
    buffer,
    "workspace/executeCommand",
    { command = command, arguments = arguments },
    function(problem, page)
      if problem then
        vim.notify("scenic: " .. problem.message, vim.log.levels.ERROR)
      elseif page then
        local path = vim.fn.tempname() .. ".html"
        vim.fn.writefile(vim.split(page, "\n"), path)
        local done = show or open
        done(path)
      end
    end
  )
end

local function run_present(command, seed, show)
  local buffer = vim.api.nvim_get_current_buf()
  run(buffer, command, { vim.uri_from_bufnr(buffer), { seed = seed or vim.fn.rand() % 1000000 } }, show)
end

--- Run the program of the present buffer, and show one scene of it in the browser.
--- `show` is called with the page's path instead, if it is given.
function M.show(seed, show)
  run_present("scenic.show", seed, show)
end

--- The same with several scenes.
function M.sample(seed, show)
  run_present("scenic.sample", seed, show)
end

--- Save the present buffer, simulate its program, and show that in the browser, or to `show` as `sample` does.
function M.simulate(seed, show)
  vim.cmd("silent update")
  run_present("scenic.simulate", seed, show)
end

--- What is run from a lens is shown too.
if vim.lsp.commands then
  for _, name in ipairs { "scenic.show", "scenic.sample", "scenic.simulate" } do
    vim.lsp.commands[name] = function(command, context)
      run(context.bufnr or vim.api.nvim_get_current_buf(), command.command, command.arguments)
    end
  end
end

return M
