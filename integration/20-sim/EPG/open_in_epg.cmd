@echo off
rem 20-sim copies this file into the folder of the export and runs it there.  It has no token of 20-sim, because the
rem name of a folder may have any character.  XXSIM_SCRIPT_MODE is 1 if a script of 20-sim exports: no window may open.
setlocal
rem The name of the folder is used only if it is needed, as on a network, because it may have any character.
set "epg_folder=."
cd /d "%~dp0." 2>nul
if not exist .\open_in_epg.cmd set "epg_folder=%~dp0."
if not "%~1"=="window" if not "%XXSIM_SCRIPT_MODE%"=="1" (
    start "Embedded-Project Generator" /d "%epg_folder%" cmd /k .\open_in_epg.cmd window
    exit /b 0
)
set "epg_option="
if "%~1"=="window" set "epg_option= --connect"
rem docs/installing.md puts EPG into Python, or into the environment of this name.
set "epg_command="
call "%USERPROFILE%\epg-environment\Scripts\epg" --version >nul 2>nul
if not errorlevel 1 set "epg_command="%USERPROFILE%\epg-environment\Scripts\epg""
call py -3 -m epg --version >nul 2>nul
if not errorlevel 1 set "epg_command=py -3 -m epg"
call epg --version >nul 2>nul
if not errorlevel 1 set "epg_command=epg"
if not defined epg_command (
    echo EPG is not installed on this computer, or not in the PATH.
    echo Type these commands, the second one with the folder of EPG, and start this file again:
    echo   winget install Python.Python.3.13
    echo   py -m pip install "folder of EPG"
    echo "%~f0"
    if exist "%~dp0ModelConfiguration.xml" echo Until then, ModelConfiguration.xml in this folder contains the path of your model file and your 20-sim license.
    exit /b 4
)
%epg_command% exported "%epg_folder%"%epg_option%
